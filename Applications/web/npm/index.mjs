// The programs of adaptiso as functions: each call runs one of them in a worker of its own. Types and what they
// mean: index.d.ts.

export class AdaptisoError extends Error {
  constructor(line, exitCode) {
    super(line);
    this.name = "AdaptisoError";
    this.exitCode = exitCode;
  }
}

const isNode = typeof process === "object" && typeof process.versions?.node === "string";
let compiled;

function compile() {
  compiled ??= (async () => {
    const url = new URL("./adaptiso.wasm", import.meta.url);
    if (!isNode) return WebAssembly.compile(await (await fetch(url)).arrayBuffer());
    const { readFile } = await import("node:fs/promises");
    return WebAssembly.compile(await readFile(url));
  })();
  return compiled;
}

/** A Web Worker, or a thread of Node with its interface. */
async function makeWorker() {
  if (!isNode) return new Worker(new URL("./worker.mjs", import.meta.url), { type: "module" });
  const threads = await import("node:worker_threads");
  const worker = new threads.Worker(new URL("./worker.mjs", import.meta.url));
  worker.on("message", (data) => worker.onmessage({ data }));
  worker.on("error", (error) => worker.onerror(error));
  return worker;
}

export async function run(program, args, files, { onProgress, signal, folders = [] } = {}) {
  signal?.throwIfAborted();
  const module = await compile(), worker = await makeWorker();
  let abort;
  try {
    return await new Promise((resolve, reject) => {
      abort = () => reject(signal.reason);
      signal?.addEventListener("abort", abort);
      if (signal?.aborted) abort();
      worker.onerror = (error) => reject(new AdaptisoError(`adaptiso-${program}: the worker failed: ${error.message}`, 4));
      worker.onmessage = ({ data }) => {
        if (data.progress !== undefined) onProgress?.(data.progress);
        else if (data.failure !== undefined) reject(new AdaptisoError(`adaptiso-${program}: ${data.failure}`, 4));
        else resolve(data.result);
      };
      worker.postMessage({ module, program, args, files, folders });
    });
  } finally {
    signal?.removeEventListener("abort", abort);
    worker.terminate();
  }
}

const kReport = "adaptiso-report.json";

/** Runs with a report. \param mayFail  exit code 1, a check failed, is no error */
async function runReported(program, args, files, options) {
  const { mayFail = false, args: further = [], ...rest } = options;
  const done = await run(program, [...args, ...further, "--json", kReport], files, rest);
  const lines = done.stderr.split("\n").filter((line) => line !== "");
  if (done.exitCode > (mayFail ? 1 : 0)) throw new AdaptisoError(lines.at(-1) ?? `adaptiso-${program} failed`, done.exitCode);
  const report = done.files.find((file) => file.path === kReport);
  return { exitCode: done.exitCode, report: JSON.parse(new TextDecoder().decode(report.bytes)),
    warnings: lines.filter((line) => line.includes("warning: ")), files: done.files.filter((file) => file !== report),
    memoryBytes: done.memoryBytes };
}

// NIfTI-1's numbers of sample types
const kTypes = [[Uint8Array, 2], [Int16Array, 4], [Int32Array, 8], [Float32Array, 16], [Float64Array, 64],
  [Int8Array, 256], [Uint16Array, 512], [Uint32Array, 768]];

function nifti({ data, size, affine }) {
  const code = kTypes.find(([type]) => data instanceof type)?.[1];
  if (code === undefined) throw new AdaptisoError("image.data is no typed array that an image may have", 3);
  if (data.length !== size[0] * size[1] * size[2]) {
    throw new AdaptisoError(`image.data has ${data.length} samples, image.size asks for ${size.join(" x ")}`, 3);
  }
  const bytes = new Uint8Array(544 + data.byteLength), view = new DataView(bytes.buffer);  // NIfTI-2: doubles
  view.setInt32(0, 540, true);
  bytes.set([0x6e, 0x2b, 0x32, 0, 13, 10, 26, 10], 4);
  view.setInt16(12, code, true);
  view.setInt16(14, 8 * data.BYTES_PER_ELEMENT, true);
  for (let n = 0; n < 8; ++n) view.setBigInt64(16 + 8 * n, BigInt(n === 0 ? 3 : size[n - 1] ?? 1), true);
  for (let n = 0; n < 8; ++n) {
    const step = n >= 1 && n <= 3 ? Math.hypot(affine[n - 1], affine[3 + n], affine[7 + n]) : n === 0 ? 1 : 0;
    view.setFloat64(104 + 8 * n, step, true);
  }
  view.setBigInt64(168, 544n, true);
  view.setInt32(348, 1, true);
  for (let n = 0; n < 12; ++n) view.setFloat64(400 + 8 * n, affine[n], true);
  view.setInt32(500, 2, true);  // mm
  bytes.set(new Uint8Array(data.buffer, data.byteOffset, data.byteLength), 544);
  return bytes;
}

/** A mesh as binary PLY in RAS. */
function ply({ points, triangles }) {
  const head = new TextEncoder().encode(`ply\nformat binary_little_endian 1.0\ncomment SPACE=RAS\nelement vertex ${points.length / 3}\n`
    + "property double x\nproperty double y\nproperty double z\n"
    + `element face ${triangles.length / 3}\nproperty list uchar int vertex_indices\nend_header\n`);
  const bytes = new Uint8Array(head.length + 8 * points.length + 13 * triangles.length / 3), view = new DataView(bytes.buffer);
  bytes.set(head);
  let at = head.length;
  for (const x of points) view.setFloat64(at, x, true), at += 8;
  for (let t = 0; t < triangles.length; t += 3) {
    view.setUint8(at++, 3);
    for (let c = 0; c < 3; ++c, at += 4) view.setInt32(at, triangles[t + c], true);
  }
  return bytes;
}

/** The points and triangles of a PLY that the programs wrote. */
function parsePly(bytes) {
  const head = new TextDecoder().decode(bytes.subarray(0, 4096)).split("end_header\n")[0];
  const count = (element) => Number(new RegExp(`element ${element} (\\d+)`).exec(head)[1]);
  const vertexPart = head.split("element vertex")[1].split("element")[0];
  const sizes = [...vertexPart.matchAll(/property (\w+) \w+/g)].map(([, type]) => (type === "double" ? 8 : type === "uchar" ? 1 : 4));
  const stride = sizes.reduce((a, b) => a + b, 0), isDouble = sizes[0] === 8;
  const view = new DataView(bytes.buffer, bytes.byteOffset + head.length + "end_header\n".length);
  const points = new (isDouble ? Float64Array : Float32Array)(3 * count("vertex")), triangles = new Uint32Array(3 * count("face"));
  for (let n = 0; n < points.length; ++n) {
    const at = Math.floor(n / 3) * stride + (n % 3) * sizes[0];
    points[n] = isDouble ? view.getFloat64(at, true) : view.getFloat32(at, true);
  }
  const first = points.length / 3 * stride;
  for (let n = 0; n < triangles.length; ++n) {
    triangles[n] = view.getInt32(first + Math.floor(n / 3) * 13 + 1 + (n % 3) * 4, true);
  }
  return { points, triangles };
}

/** \param toBytes  of arrays \param name  what arrays are called */
async function toFile(input, toBytes, name) {
  if (typeof File === "function" && input instanceof File) {
    return { path: input.name, bytes: new Uint8Array(await input.arrayBuffer()) };
  }
  if (input?.bytes !== undefined) return { path: input.path, bytes: new Uint8Array(input.bytes) };
  return { path: name, bytes: toBytes(input) };
}
const imageFile = (input, name = "image.nii") => toFile(input, nifti, name);
const meshFile = (input, name = "surface.ply") => toFile(input, ply, name);

function aimOf({ maxErrorMm, triangles }) {
  return [...(maxErrorMm === undefined ? [] : ["--max-error", String(maxErrorMm)]),
    ...(triangles === undefined ? [] : ["--triangles", String(triangles)])];
}

async function makeSurface(program, args, files, options) {
  const { iso: _iso, maxErrorMm: _mm, triangles: _count, ...rest } = options;
  const kOutput = "adaptiso-surface.ply";
  const done = await runReported(program, [...args, "--coordinates", "ras", "-o", kOutput], files, rest);
  return { ...done, mesh: parsePly(done.files.find((file) => file.path === kOutput).bytes) };
}

export async function mesh(image, options = {}) {
  const file = await imageFile(image);
  return makeSurface("mesh", [file.path, "--iso", String(options.iso ?? "auto"), ...aimOf(options)], [file], options);
}

export async function simplify(surface, options = {}) {
  const file = await meshFile(surface);
  return makeSurface("simplify", [file.path, ...aimOf(options)], [file], options);
}

export async function check(surfaces, options = {}) {
  const all = Array.isArray(surfaces) ? surfaces : [surfaces];
  const files = await Promise.all(all.map((one, n) => meshFile(one, `surface-${n + 1}.ply`)));
  return runReported("check", files.map((file) => file.path), files, { ...options, mayFail: true });
}

export async function compare(a, b, options = {}) {
  const files = [await meshFile(a, "a.ply"), await meshFile(b, "b.ply")];
  return runReported("compare", files.map((file) => file.path), files, { ...options, mayFail: true });
}

export async function labels(image, { format = "stl", ...options } = {}) {
  const file = await imageFile(image, "labels.nii");
  return runReported("labels", [file.path, "-o", "regions", "--format", format], [file], options);
}

export async function bem(t1, { mask, vertices, ...options } = {}) {
  const files = [await imageFile(t1, "t1.nii"), ...(mask === undefined ? [] : [await imageFile(mask, "mask.nii")])];
  return runReported("bem", ["--t1", files[0].path, ...(mask === undefined ? [] : ["--brain-mask", files[1].path]),
    ...(vertices === undefined ? [] : ["--vertices", String(vertices)]), "-o", "model"], files, options);
}
