/** A GLB (glTF 2.0 in one file) of surfaces with their names and colours, for viewers. */
import type { Surface } from "./painter";

const kFloat = 5126, kByte = 5121, kIndex = 5125, kPoints = 34962, kTriangles = 34963;
/** glTF's colours are linear, those of a screen are not. */
const linear = (shade: number): number => shade <= 0.04045 ? shade / 12.92 : ((shade + 0.055) / 1.055) ** 2.4;

function unitNormals(normals: Float32Array): Float32Array {
  const unit = new Float32Array(normals.length);
  for (let n = 0; n < normals.length; n += 3) {
    const length = Math.hypot(normals[n], normals[n + 1], normals[n + 2]);
    for (let axis = 0; axis < 3; ++axis) unit[n + axis] = length > 0 ? normals[n + axis] / length : Number(axis === 2);
  }
  return unit;
}

/**
 * Points stay scanner RAS mm in the buffer; a node turns them so that the head is upright and faces the viewer
 * (glTF: Y up, Z to the front), and scales them to glTF's metres.
 */
export function glb(surfaces: Surface[], generator: string): Blob {
  const parts: Uint8Array<ArrayBuffer>[] = [], views: object[] = [], accessors: object[] = [];
  let bytes = 0;
  const add = (data: Float32Array | Uint32Array | Uint8Array, target: number, accessor: object): number => {
    views.push({ buffer: 0, byteOffset: bytes, byteLength: data.byteLength, target });
    parts.push(new Uint8Array(data.buffer as ArrayBuffer, data.byteOffset, data.byteLength));
    bytes += data.byteLength;
    return accessors.push({ bufferView: views.length - 1, ...accessor }) - 1;
  };
  const meshes = surfaces.map(({ name, shape, colors }, material) => {
    const count = shape.points.length / 3, min = [Infinity, Infinity, Infinity], max = [-Infinity, -Infinity, -Infinity];
    shape.points.forEach((value, n) => {
      min[n % 3] = Math.min(min[n % 3], value);
      max[n % 3] = Math.max(max[n % 3], value);
    });
    const attributes = {
      POSITION: add(shape.points, kPoints, { componentType: kFloat, count, type: "VEC3", min, max }),
      NORMAL: add(unitNormals(shape.normals), kPoints, { componentType: kFloat, count, type: "VEC3" }),
      ...(colors && { COLOR_0: add(colors.map((shade, n) => n % 4 === 3 ? shade : 255 * linear(shade / 255) + 0.5), kPoints,
        { componentType: kByte, count, type: "VEC4", normalized: true }) }),
    };
    const indices = add(shape.triangles, kTriangles, { componentType: kIndex, count: shape.triangles.length, type: "SCALAR" });
    return { name, primitives: [{ attributes, indices, material }] };
  });
  const materials = surfaces.map(({ name, color, colors, opacity }) => ({ name, pbrMetallicRoughness: { metallicFactor: 0,
    roughnessFactor: 0.6, baseColorFactor: [...(colors ? [1, 1, 1] : color.map((shade) => linear(shade / 255))), opacity] },
    ...(opacity < 1 && { alphaMode: "BLEND", doubleSided: true }) }));
  const scene = { asset: { version: "2.0", generator, extras: { frame: "scanner RAS mm; the root node turns to glTF's axes and metres" } },
    scene: 0, scenes: [{ nodes: [0] }],
    nodes: [{ name: "RAS mm", rotation: [0, Math.SQRT1_2, Math.SQRT1_2, 0], scale: [0.001, 0.001, 0.001],
      children: meshes.map((_, n) => n + 1) }, ...meshes.map(({ name }, mesh) => ({ name, mesh }))],
    meshes, materials, accessors, bufferViews: views, buffers: [{ byteLength: bytes }] };
  const text = new TextEncoder().encode(JSON.stringify(scene)), json = new Uint8Array(4 * Math.ceil(text.length / 4)).fill(0x20);
  json.set(text);
  const words = (...numbers: number[]): Uint8Array<ArrayBuffer> => {
    const view = new DataView(new ArrayBuffer(4 * numbers.length));
    numbers.forEach((number, n) => { view.setUint32(4 * n, number, true); });
    return new Uint8Array(view.buffer);
  };
  const kMagic = 0x46546c67, kJson = 0x4e4f534a, kBin = 0x004e4942;
  return new Blob([words(kMagic, 2, 28 + json.length + bytes, json.length, kJson), json, words(bytes, kBin), ...parts],
    { type: "model/gltf-binary" });
}
