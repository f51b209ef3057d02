/** NIfTI-1 files that the page itself makes: what niivue shows, and the example. */

/** \param affine  three rows of four, RAS mm  \param sampleBytes  of a sample: 1, or 2 with the lower first */
export function nifti(size: number[], affine: number[], samples: Uint8Array, sampleBytes = 1): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(352 + samples.length), view = new DataView(bytes.buffer);
  view.setInt32(0, 348, true);
  view.setInt16(40, 3, true);
  for (let axis = 0; axis < 3; ++axis) {
    view.setInt16(42 + 2 * axis, size[axis], true);
    view.setFloat32(80 + 4 * axis, Math.hypot(affine[axis], affine[4 + axis], affine[8 + axis]), true);
  }
  for (let n = 4; n < 8; ++n) view.setInt16(40 + 2 * n, 1, true);
  view.setInt16(70, sampleBytes === 1 ? 2 : 512, true);  // unsigned
  view.setInt16(72, 8 * sampleBytes, true);
  view.setFloat32(76, 1, true);
  view.setFloat32(108, 352, true);
  view.setFloat32(112, 1, true);
  view.setFloat32(124, 255, true);
  bytes[123] = 2;  // mm
  view.setInt16(254, 1, true);
  for (let n = 0; n < 12; ++n) view.setFloat32(280 + 4 * n, affine[n], true);
  bytes.set([0x6e, 0x2b, 0x31], 344);  // "n+1"
  bytes.set(samples, 352);
  return bytes;
}

/** The labels of exampleHead(true), as adaptiso-bem takes them. */
export const kExampleTissues = "brain=1 skull=2 scalp=3";

/** A head of 2 mm voxels: skin, skull, CSF, a folded brain with ventricles, eyes, nose, ears, a neck, and noise
 * that is the same every time; or its tissues as labels. */
export function exampleHead(asLabels = false): Uint8Array<ArrayBuffer> {
  const size = [84, 104, 92], samples = new Uint8Array(size[0] * size[1] * size[2]);
  let seed = 1;
  const noise = (): number => {
    seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
    return (seed >>> 24) / 255 - 0.5;
  };
  const depthIn = (x: number, y: number, z: number, rx: number, ry: number, rz: number): number =>
    (1 - Math.hypot(x / rx, y / ry, z / rz)) * Math.min(rx, ry, rz);
  for (let k = 0, n = 0; k < size[2]; ++k) {
    for (let j = 0; j < size[1]; ++j) {
      for (let i = 0; i < size[0]; ++i, ++n) {
        const x = 2 * i - 83, y = 2 * j - 105, z = 2 * k - 92;
        const skin = depthIn(x, y, z, 76, 96, 86);
        const nose = depthIn(x, y - 86, z + 30, 11, 16, 20), ear = depthIn(Math.abs(x) - 73, y + 6, z + 14, 8, 16, 22);
        const neck = z < -40 ? 46 - Math.hypot(x, y + 14) : -1;
        const folds = 2.4 * Math.sin(x / 4.5 + Math.sin(z / 7)) * Math.sin(y / 5.5) * Math.sin(z / 5 + Math.cos(x / 9));
        const brain = depthIn(x, y, z - 6, 61, 79, 68) + folds - Math.max(0, 3.5 - Math.abs(x)) * (z > 20 ? 1.5 : 0);
        const ventricle = depthIn(Math.abs(x) - 9, y + 4, z - 12, 6, 26, 9);
        if (asLabels) {
          samples[n] = skin > 11 ? 1 : skin > 5 ? 2 : Math.max(skin, nose, ear, neck) > 0 ? 3 : 0;
          continue;
        }
        let value = 6;
        if (Math.max(skin, nose, ear, neck) > 0) value = 150;
        if (skin > 5) value = 35;
        if (skin > 11) value = 55;
        if (brain > 0) value = brain > 5 ? 178 : 128;
        if (brain > 0 && ventricle > 0) value = 48;
        const eye = depthIn(Math.abs(x) - 28, y - 67, z + 22, 11, 11, 11);
        if (eye > 0 && brain <= 0) value = 52;
        samples[n] = Math.max(0, Math.round(value + 9 * (noise() + noise() + noise())));
      }
    }
  }
  return nifti(size, [2, 0, 0, -83, 0, 2, 0, -105, 0, 0, 2, -92], samples);
}
