// The programs of adaptiso as functions: each call runs one of them in a worker of its own. Types and what they
// mean: index.d.ts.

/** Characters that act on a terminal, or turn a line's order round. */
const kControls = /[\p{Cc}\u061c\u200e\u200f\ufeff\u2028-\u202e\u2066-\u2069\u{e0000}-\u{e007f}]/gu;

export class AdaptisoError extends Error {
  constructor(line, exitCode) {
    super(line.replace(kControls, " "));
    this.name = "AdaptisoError";
    this.exitCode = exitCode;
  }
}

const isNode = typeof process === "object" && typeof process.versions?.node === "string";
let compiled;

async function readWasm() {
  const url = new URL("./adaptiso.wasm", import.meta.url);
  if (isNode) return (await import("node:fs/promises")).readFile(url);
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: HTTP ${response.status}`);
  return response.arrayBuffer();
}

/** Once for all runs; after a failure the next run tries again. */
function compile() {
  compiled ??= readWasm().then((bytes) => WebAssembly.compile(bytes)).catch((error) => {
    compiled = undefined;
    throw new AdaptisoError(`adaptiso.wasm cannot be loaded: ${error.message}`, 4);
  });
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

/** A path below the job's folder: `./x` is `x`. */
function normalPath(path) {
  const parts = String(path).split("/").filter((part) => part !== "" && part !== ".");
  if (typeof path !== "string" || path.startsWith("/") || parts.length === 0 || parts.includes("..")) {
    throw new AdaptisoError(`the path "${path}" must be relative, without "..": give the file's name`, 2);
  }
  const kMost = 1000;  // characters: each folder takes time
  if (path.length > kMost) throw new AdaptisoError(`the path "${path.slice(0, 40)}..." is too long: at most ${kMost} characters`, 2);
  return parts.join("/");
}

function normalFile(file) {
  if (typeof file !== "object" || file === null) throw new AdaptisoError("a file must be { path, bytes }", 2);
  const { path, bytes } = file;
  if (!(bytes instanceof Uint8Array)) throw new AdaptisoError(`${path}: bytes must be a Uint8Array`, 2);
  return { path: normalPath(path), bytes };
}

function requireStrings(args) {
  const areStrings = Array.isArray(args) && args.every((each) => typeof each === "string");
  if (!areStrings) throw new AdaptisoError("args must be an array of strings", 2);
}

/** A file has a path of its own, which is no folder. */
function requireApart(paths, folders) {
  const files = new Set();
  for (const path of paths) {
    if (files.has(path)) throw new AdaptisoError(`two files have the path "${path}": give each a path of its own`, 2);
    files.add(path);
  }
  const above = (path) => path.split("/").map((_, n, parts) => parts.slice(0, n).join("/")).slice(1);
  const both = [...paths.flatMap(above), ...folders.flatMap((folder) => [...above(folder), folder])].find((path) => files.has(path));
  if (both !== undefined) throw new AdaptisoError(`the path "${both}" is a file and a folder: give each a path of its own`, 2);
}

export async function run(program, args, files, { onProgress, signal, folders = [] } = {}) {
  signal?.throwIfAborted();
  requireStrings(args);
  if (!Array.isArray(files)) throw new AdaptisoError("files must be an array", 2);
  const job = { program, args, files: files.map(normalFile), folders: folders.map(normalPath) };
  requireApart(job.files.map((file) => file.path), job.folders);
  const module = await compile(), worker = await makeWorker();
  let abort;
  try {
    return await new Promise((resolve, reject) => {
      abort = () => reject(signal.reason);
      signal?.addEventListener("abort", abort);
      if (signal?.aborted) abort();
      worker.onerror = (error) => reject(new AdaptisoError(`adaptiso-${program}: the worker failed: ${error.message}`, 4));
      const report = (progress) => {
        try {
          onProgress?.(progress);
        } catch (error) {
          reject(error);
        }
      };
      worker.onmessage = ({ data }) => {
        if (data.progress !== undefined) report(data.progress);
        else if (data.failure !== undefined) reject(new AdaptisoError(`adaptiso-${program}: ${data.failure}`, 4));
        else resolve(data.result);
      };
      worker.postMessage({ module, ...job });
    });
  } finally {
    signal?.removeEventListener("abort", abort);
    worker.terminate();
  }
}

const kReport = "adaptiso-report.json", kSurface = "adaptiso-surface.ply", kRegions = "regions", kModel = "model";

/** Inputs at their own names; in folders 1, 2, ... where two have the same, or one has an output's. */
function apart(inputs) {
  const files = inputs.map(normalFile), paths = [...files.map((file) => file.path), kReport, kSurface, kRegions, kModel];
  const meet = paths.some((one, n) => paths.some((other, m) => n !== m && `${other}/`.startsWith(`${one}/`)));
  return meet ? files.map(({ path, bytes }, n) => ({ path: `${n + 1}/${path}`, bytes })) : files;
}

function writtenFile(program, done, path) {
  const file = done.files.find((each) => each.path === path);
  if (file === undefined) {
    throw new AdaptisoError(`adaptiso-${program}: wrote no result with these options.args: use run() for them`, 2);
  }
  return file;
}

/** Options as the program has them: `maxErrorMm: 0.5` is --max-error=0.5. */
function namedOptions(options) {
  return Object.entries(options).filter(([, value]) => value !== undefined && value !== false).map(([key, value]) => {
    const name = key.replace(/(Mm3?|Deg)$/, "").replace(/[A-Z]/g, (letter) => `-${letter.toLowerCase()}`);
    return value === true ? `--${name}` : `--${name}=${value}`;
  });
}

/** Runs with a report. \param mayFail  exit code 1, a check failed, is no error \param inputs  after all options */
async function runReported(program, args, inputs, files, options) {
  const { mayFail = false, args: further = [], onProgress, signal, ...named } = options;
  requireStrings(further);
  const done = await run(program, [...args, ...namedOptions(named), ...further, "--json", kReport, ...(inputs.length > 0 ? ["--"] : []), ...inputs],
    files, { onProgress, signal });
  const lines = done.stderr.split("\n").filter((line) => line !== "");
  if (done.exitCode > (mayFail ? 1 : 0)) throw new AdaptisoError(lines.at(-1) ?? `adaptiso-${program} failed`, done.exitCode);
  const report = writtenFile(program, done, kReport);
  const json = JSON.parse(new TextDecoder().decode(report.bytes));
  return { exitCode: done.exitCode, report: json,
    warnings: json.warnings.map(({ file, text }) => (file === null ? text : `${file}: ${text}`)),
    files: done.files.filter((file) => file !== report), memoryBytes: done.memoryBytes };
}

// NIfTI-1's numbers of sample types
const kTypes = [[Uint8Array, 2], [Int16Array, 4], [Int32Array, 8], [Float32Array, 16], [Float64Array, 64],
  [Int8Array, 256], [Uint16Array, 512], [Uint32Array, 768]];

function nifti({ data, size, affine }) {
  const code = kTypes.find(([type]) => data instanceof type)?.[1];
  if (code === undefined) throw new AdaptisoError("image.data is no typed array that an image may have", 3);
  if (size?.length !== 3 || !Array.from(size).every((n) => Number.isSafeInteger(n) && n > 0)) {
    throw new AdaptisoError("image.size must be three whole numbers above 0: voxels along i, j, k", 3);
  }
  if (![12, 16].includes(affine?.length) || !Array.from(affine).every(Number.isFinite)) {
    throw new AdaptisoError("image.affine must be 12 or 16 finite numbers, row by row: voxel index to scanner RAS mm", 3);
  }
  if (affine.length === 16 && [0, 0, 0, 1].some((x, n) => affine[12 + n] !== x)) {
    throw new AdaptisoError("image.affine's fourth row must be 0, 0, 0, 1: give the matrix row by row", 3);
  }
  if (data.length !== size[0] * size[1] * size[2]) {
    throw new AdaptisoError(`image.data has ${data.length} samples, image.size asks for ${Array.from(size).join(" x ")}`, 3);
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
  const isOf = (array, types) => types.some((type) => array instanceof type) && array.length % 3 === 0;
  const kWhole = [Uint32Array, Int32Array, Uint16Array, Int16Array, Uint8Array, Int8Array], kNumbers = [Float64Array, Float32Array, ...kWhole];
  if (!isOf(points, kNumbers) || !isOf(triangles, kWhole)) {
    throw new AdaptisoError("mesh.points and mesh.triangles must be typed arrays, three numbers each, of triangles whole ones", 3);
  }
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
  const head = new TextDecoder("latin1").decode(bytes.subarray(0, 4096)).split("end_header\n")[0];
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
  if (typeof input !== "object" || input === null) throw new AdaptisoError("an input must be arrays, a NamedFile or a File", 2);
  if (typeof input.arrayBuffer === "function") {  // also of node:buffer, which is no global of Node 18
    if (typeof input.name !== "string") throw new AdaptisoError("an input without a name: give a File, or { path, bytes }", 2);
    return { path: input.name, bytes: new Uint8Array(await input.arrayBuffer()) };
  }
  if (input.bytes !== undefined) return input;
  return { path: name, bytes: toBytes(input) };
}
const imageFile = (input, name = "image.nii") => toFile(input, nifti, name);
const meshFile = (input, name = "surface.ply") => toFile(input, ply, name);

/** `more`: options whose value is a file, each with it. */
async function makeSurface(program, args, file, options, more = []) {
  const files = apart([file, ...more.map(([, each]) => each)]), others = more.flatMap(([option], n) => [option, files[n + 1].path]);
  const done = await runReported(program, [...args, ...others, "--coordinates", "ras", "-o", kSurface], [files[0].path], files, options);
  return { ...done, mesh: parsePly(writtenFile(program, done, kSurface).bytes) };
}

export async function mesh(image, { iso = "auto", ...options } = {}) {
  return makeSurface("mesh", ["--iso", String(iso)], await imageFile(image), options);
}

export async function simplify(surface, options = {}) {
  return makeSurface("simplify", [], await meshFile(surface), options);
}

export async function mend(surface, { around, ...options } = {}) {
  return makeSurface("mend", [], await meshFile(surface), options, around === undefined ? [] : [["--around", await meshFile(around, "around.ply")]]);
}

export async function check(surfaces, options = {}) {
  const all = Array.isArray(surfaces) ? surfaces : [surfaces];
  const files = apart(await Promise.all(all.map((one, n) => meshFile(one, `surface-${n + 1}.ply`))));
  return runReported("check", [], files.map((file) => file.path), files, { ...options, mayFail: true });
}

export async function compare(a, b, options = {}) {
  const files = apart([await meshFile(a, "a.ply"), await meshFile(b, "b.ply")]);
  return runReported("compare", [], files.map((file) => file.path), files, { ...options, mayFail: true });
}

export async function labels(image, { format = "stl", ...options } = {}) {
  const [file] = apart([await imageFile(image, "labels.nii")]);
  return runReported("labels", ["-o", kRegions, "--format", format], [file.path], [file], options);
}

export async function bem(t1, { mask, ...options } = {}) {
  const files = apart([await imageFile(t1, "t1.nii"), ...(mask === undefined ? [] : [await imageFile(mask, "mask.nii")])]);
  return runReported("bem", [`--t1=${files[0].path}`, ...(mask === undefined ? [] : [`--brain-mask=${files[1].path}`]),
    "-o", kModel], [], files, options);
}
