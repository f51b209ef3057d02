// An extension of NiiVue: surfaces of the volumes it shows. Types: niivue.d.ts.
import { mesh } from "./index.mjs";

export async function addSurface(niivue, { volume = niivue.volumes[0], rgba255 = [240, 190, 120, 255], ...options } = {}) {
  if (volume === undefined) throw new Error("addSurface: niivue shows no volume: load one first");
  const done = await mesh({ path: "volume.nii", bytes: await volume.saveToUint8Array("volume.nii") }, options);
  const { buffer } = done.files.find(({ path }) => path.endsWith(".ply")).bytes;
  const added = await niivue.addMeshFromUrl({ url: "surface.ply", name: `${volume.name}.ply`, rgba255, buffer });
  return { ...done, added };
}
