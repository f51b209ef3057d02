/** Parts of the page's file that are kept as gzip in base64: <script type="text/plain" id="...">. */
async function unpack(id: string): Promise<Response> {
  const element = document.getElementById(id);
  const packed = await fetch(`data:;base64,${element?.textContent?.trim()}`);
  element?.remove();  // the text would stay in memory
  return new Response(packed.body?.pipeThrough(new DecompressionStream("gzip")));
}
export const unpackText = async (id: string): Promise<string> => (await unpack(id)).text();
export const unpackBytes = async (id: string): Promise<ArrayBuffer> => (await unpack(id)).arrayBuffer();
