/** Box, pieces, cavities and inside of a mesh. */
import type { Shape } from "./protocol";

export function boundsOf(shapes: Shape[]): { low: number[]; high: number[] } {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (const { points } of shapes) {
    for (let n = 0; n < points.length; ++n) {
      const value = points[n];
      if (!Number.isFinite(value)) continue;
      low[n % 3] = Math.min(low[n % 3], value);
      high[n % 3] = Math.max(high[n % 3], value);
    }
  }
  return { low, high };
}

/** Connected pieces of a closed surface, and the surfaces of cavities in them. */
export function countPieces({ points, triangles, normals }: Shape): { pieces: number; cavities: number } {
  const parents = Uint32Array.from({ length: points.length / 3 }, (_, n) => n);
  const rootOf = (n: number): number => {
    while (parents[n] !== n) n = parents[n] = parents[parents[n]];
    return n;
  };
  for (let t = 0; t < triangles.length; ++t) parents[rootOf(triangles[t])] = rootOf(triangles[t - t % 3]);
  const ends = new Map<number, number>();  // of each piece, its vertex farthest right, whose normal is outward
  for (let n = 0; n < parents.length; ++n) {
    const root = rootOf(n), end = ends.get(root);
    if (end === undefined || points[3 * n] > points[3 * end]) ends.set(root, n);
  }
  const cavities = [...ends.values()].filter((end) => normals[3 * end] < 0).length;
  return { pieces: ends.size - cavities, cavities };
}

/** Tests points for lying inside a closed surface: an odd number of its triangles is above them. */
export function insideOf(shape: Shape): (x: number, y: number, z: number) => boolean {
  const { points, triangles } = shape, { low, high } = boundsOf([shape]), size = Math.ceil(Math.sqrt(triangles.length / 6));
  const cellOf = (value: number, axis: number): number =>
    Math.min(size - 1, Math.max(0, Math.floor((value - low[axis]) / (high[axis] - low[axis] || 1) * size)));
  const columns = Array.from({ length: size * size }, (): number[] => []);  // of each cell in x and y, the triangles over it
  for (let t = 0; t < triangles.length; t += 3) {
    const [[left, right], [front, back]] = [0, 1].map((axis) => {
      const cells = [0, 1, 2].map((side) => cellOf(points[3 * triangles[t + side] + axis], axis));
      return [Math.min(...cells), Math.max(...cells)];
    });
    for (let i = left; i <= right; ++i) {
      for (let j = front; j <= back; ++j) columns[i * size + j].push(t);
    }
  }
  return (px, py, z) => {
    const x = px + 1.3e-5, y = py + 0.7e-5;  // beside the planes of voxels, on which vertices lie
    let isInside = false;
    for (const t of columns[cellOf(x, 0) * size + cellOf(y, 1)]) {
      const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
      const over = (from: number, to: number): number =>
        (points[from] - x) * (points[to + 1] - y) - (points[from + 1] - y) * (points[to] - x);
      const ab = over(a, b), bc = over(b, c), ca = over(c, a);
      if ((ab > 0) !== (bc > 0) || (ab > 0) !== (ca > 0)) continue;
      if ((bc * points[a + 2] + ca * points[b + 2] + ab * points[c + 2]) / (ab + bc + ca) > z) isInside = !isInside;
    }
    return isInside;
  };
}
