/** Parts of the page's file that are kept as gzip in base64: <script type="text/plain" id="...">. */
async function unpack(id: string): Promise<Response> {
  const element = document.getElementById(id);
  const packed = Uint8Array.from(atob(element?.textContent?.trim() ?? ""), (c) => c.charCodeAt(0));
  element?.remove();  // the text would stay in memory
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip")));
}
export const unpackText = async (id: string): Promise<string> => (await unpack(id)).text();
export const unpackBytes = async (id: string): Promise<ArrayBuffer> => (await unpack(id)).arrayBuffer();
