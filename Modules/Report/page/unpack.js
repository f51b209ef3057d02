"use strict";
// Unpacks niivue (#niivue: gzip, base64), then runs the viewer (#viewer-code).
(async function () {
  const byId = (id) => document.getElementById(id);
  const run = (code) => document.head.append(
    Object.assign(document.createElement("script"), { textContent: code }));
  try {
    const packed = Uint8Array.from(atob(byId("niivue").textContent.trim()), (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    run(await new Response(stream).text());
    run(byId("viewer-code").textContent);
  } catch (error) {
    byId("viewer-missing").textContent = "The viewer could not be started: " + error.message;
    byId("viewer-missing").hidden = false;
    document.body.dataset.viewer = "missing";
  }
})();
