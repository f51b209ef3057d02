import type { MeshOptions, MeshResult } from "./index.d.ts";

export interface SurfaceOptions extends MeshOptions {
  /** The first that is shown, unless given. */
  volume?: { name: string; saveToUint8Array(name: string): Promise<Uint8Array> };
  rgba255?: number[];
}
/** The surface of a volume that a NiiVue (`@niivue/niivue`) shows, added to its meshes; `added` is NiiVue's mesh. */
export function addSurface(niivue: { volumes: any[]; addMeshFromUrl(options: any): Promise<any> },
  options?: SurfaceOptions): Promise<MeshResult & { added: any }>;
