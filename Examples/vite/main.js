// The surface of an image that is chosen, made in a worker; nothing is sent.
import { AdaptisoError, mesh } from "adaptiso";

const [image, cancel, state, save] = ["image", "cancel", "state", "save"].map((id) => document.getElementById(id));
let controller = new AbortController();
cancel.addEventListener("click", () => controller.abort());

image.addEventListener("change", async () => {
  controller.abort();
  const { signal } = controller = new AbortController();
  save.hidden = true;
  cancel.disabled = false;
  try {
    const done = await mesh(image.files[0], { iso: "auto", maxErrorMm: 0.5, signal,
      onProgress: (text) => { state.textContent = text; } });
    state.textContent = `${done.mesh.triangles.length / 3} triangles`;
    URL.revokeObjectURL(save.href);
    save.href = URL.createObjectURL(new Blob([done.files[0].bytes]));
    save.hidden = false;
  } catch (error) {
    if (signal.aborted) state.textContent = "Cancelled.";
    else if (error instanceof AdaptisoError) state.textContent = error.message;
    else throw error;
  }
  cancel.disabled = true;
});
