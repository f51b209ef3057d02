/**
 * A worker runs one program in one instance of the WebAssembly, as a process does, or keeps one to look
 * at an image. The glue that Emscripten made stands above this code and defines createAdaptiso().
 */
import type { Message, OpenedImage, OpenedMesh, OpenRequest, OutputFile, Reply, RunRequest, RunResult,
  Series, Shape, InputFile } from "./protocol";

interface FileSystem {
  mkdirTree(path: string): void;
  chdir(path: string): void;
  writeFile(path: string, bytes: Uint8Array, options: { canOwn: boolean }): void;
  readFile(path: string): Uint8Array;
  readdir(path: string): string[];
  stat(path: string): { mode: number };
  isDir(mode: number): boolean;
  unlink(path: string): void;
  analyzePath(path: string): { exists: boolean };
}
interface Instance {
  FS: FileSystem;
  HEAPU8: Uint8Array;
  HEAPF32: Float32Array;
  HEAPU32: Uint32Array;
  callMain(args: string[]): number;
  ccall(name: string, result: string, types: string[], args: unknown[]): number | string;
}
declare function createAdaptiso(options: Record<string, unknown>): Promise<Instance>;

const kFolder = "/work";
let module: WebAssembly.Module;
let looker: Promise<Instance> | undefined;

function reply(message: Reply, transfer: Transferable[] = []): void {
  (self as unknown as Worker).postMessage(message, transfer);
}

async function makeInstance(options: Record<string, unknown>): Promise<Instance> {
  const instance = await new Promise<Instance>((resolve, reject) => createAdaptiso({
    ...options,
    instantiateWasm: (imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void) => {
      WebAssembly.instantiate(module, imports).then(done).catch(reject);  // which the glue waits for without end
      return {};
    },
    quit: (_status: number, thrown: unknown) => { throw thrown; },
  }).then(resolve, reject));
  instance.FS.mkdirTree(kFolder);
  instance.FS.chdir(kFolder);
  return instance;
}

async function bytesOf(data: Blob | Uint8Array): Promise<Uint8Array> {
  if (data instanceof Uint8Array) return data;
  const bytes = new Uint8Array(data.size), kPiece = 2 ** 28;  // browsers read less than 2 GiB at once
  for (let at = 0; at < data.size; at += kPiece) bytes.set(new Uint8Array(await data.slice(at, at + kPiece).arrayBuffer()), at);
  return bytes;
}

async function put(fs: FileSystem, file: InputFile): Promise<void> {
  const folder = file.path.split("/").slice(0, -1).join("/");
  if (folder !== "") fs.mkdirTree(`${kFolder}/${folder}`);  // from the root, whatever the folder is
  fs.writeFile(file.path, await bytesOf(file.data), { canOwn: true });
}

/** Regular files below the job's folder. */
function listFiles(fs: FileSystem, folder: string): string[] {
  return fs.readdir(folder).filter((name) => name !== "." && name !== "..").sort().flatMap((name) => {
    const path = folder === "." ? name : `${folder}/${name}`;
    return fs.isDir(fs.stat(path).mode) ? listFiles(fs, path) : [path];
  });
}

async function run(id: number, request: RunRequest): Promise<void> {
  const stderr: string[] = [];
  const instance = await makeInstance({
    thisProgram: request.program,
    print: () => {},  // the report has it
    printErr: (line: string) => stderr.push(line),
    onProgress: (text: string) => reply({ id, kind: "progress", text }),
  });
  for (const folder of request.folders) instance.FS.mkdirTree(`${kFolder}/${folder}`);
  for (const file of request.files) await put(instance.FS, file);
  const given = new Set(request.files.map((file) => file.path.replace(/(^|\/)\.\//, "$1")));
  const begin = performance.now();
  const exitCode = instance.callMain(request.args);
  const seconds = (performance.now() - begin) / 1000;
  const files: OutputFile[] = listFiles(instance.FS, ".").filter((path) => !given.has(path))
    .map((path) => ({ path, bytes: instance.FS.readFile(path) }));
  const result: RunResult = { exitCode, stderr: stderr.join("\n"), files,
    memoryBytes: instance.HEAPU8.length, seconds };
  reply({ id, kind: "done", result }, files.map((file) => file.bytes.buffer));
}

const answerOf = (instance: Instance): string => instance.ccall("adaptisoAnswer", "string", [], []) as string;

/** \throws Refusal */
class Refusal extends Error {
  constructor(readonly line: string, readonly exitCode: number, readonly volumes: number | null, readonly hasSeries: boolean,
    readonly series: Series[] = []) { super(line); }
}

function call<T = Record<string, unknown>>(instance: Instance, name: string, types: string[], args: unknown[]): T {
  const exitCode = instance.ccall(name, "number", types, args) as number;
  const answer = JSON.parse(answerOf(instance));
  if (exitCode !== 0) throw new Refusal(answer.line, exitCode, answer.volumes, answer.hasSeries);
  return answer;
}

/** Opens the image; where it has to be chosen from several series, the refusal has them. */
function openImage(instance: Instance, request: OpenRequest): Record<string, unknown> {
  try {
    return call(instance, "adaptisoOpenImage", ["string", "string", "number"],
      [request.path, JSON.stringify(request.read), request.isLabels ? 1 : 0]);
  } catch (error) {
    if (!(error instanceof Refusal) || !error.hasSeries) throw error;
    throw new Refusal(error.line, error.exitCode, null, true, call<Series[]>(instance, "adaptisoListSeries", ["string"], [request.path]));
  }
}

const address = (instance: Instance, name: string): number =>
  instance.ccall(name, "number", [], []) as number >>> 0;

/** Area-weighted, not of unit length: for drawing alone. */
function normalsOf(points: Float32Array, triangles: Uint32Array): Float32Array {
  const normals = new Float32Array(points.length);
  for (let n = 0; n < triangles.length; n += 3) {
    const a = 3 * triangles[n], b = 3 * triangles[n + 1], c = 3 * triangles[n + 2];
    const ux = points[b] - points[a], uy = points[b + 1] - points[a + 1], uz = points[b + 2] - points[a + 2];
    const vx = points[c] - points[a], vy = points[c + 1] - points[a + 1], vz = points[c + 2] - points[a + 2];
    const x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    for (const corner of [a, b, c]) {
      normals[corner] += x;
      normals[corner + 1] += y;
      normals[corner + 2] += z;
    }
  }
  return normals;
}

/** \param facts  adaptisoAnswer()'s: counts, and whether there are values */
function shapeOf(instance: Instance, facts: Record<string, unknown>): Shape {
  const from = address(instance, "adaptisoPoints") / 4, corners = address(instance, "adaptisoTriangles") / 4;
  const at = address(instance, "adaptisoValues") / 4;
  const given = instance.HEAPU32.slice(corners, corners + 3 * (facts.triangles as number));
  const count = facts.points as number ?? given.reduce((most, corner) => Math.max(most, corner + 1), 0);
  const points = instance.HEAPF32.slice(from, from + 3 * count);
  // a damaged mesh names points that are not there
  const triangles = given.every((corner) => corner < count) ? given
    : given.filter((_, n) => [0, 1, 2].every((side) => given[n - n % 3 + side] < count));
  return { points, triangles, normals: normalsOf(points, triangles),
    values: typeof facts.values === "string" ? instance.HEAPF32.slice(at, at + count) : null };
}

const buffersOf = (shape: Shape): Transferable[] =>
  [shape.points, shape.triangles, shape.normals, ...(shape.values ? [shape.values] : [])].map((part) => part.buffer);

async function open(request: OpenRequest): Promise<OpenedImage> {
  const instance = await makeInstance({ print: () => {}, printErr: () => {} });
  looker = Promise.resolve(instance);
  for (const file of request.files) await put(instance.FS, file);
  const facts = openImage(instance, request);
  for (const file of request.files) instance.FS.unlink(file.path);
  const begin = address(instance, "adaptisoShades"), count = address(instance, "adaptisoShadeCount");
  return { facts: facts as unknown as OpenedImage["facts"],
    shades: instance.HEAPU8.slice(begin, begin + count) };
}

async function handle(id: number, request: Message["request"]): Promise<void> {
  if (request.kind === "run") return run(id, request);
  if (request.kind === "open") return reply({ id, kind: "done", result: await open(request) });
  looker ??= makeInstance({ print: () => {}, printErr: () => {} });
  const instance = await looker;
  if (request.kind === "preview") {
    const shape = shapeOf(instance, call(instance, "adaptisoPreview", ["number"], [request.isovalue]));
    return reply({ id, kind: "done", result: shape }, buffersOf(shape));
  }
  if (request.kind === "edges") {
    return reply({ id, kind: "done", result: instance.ccall("adaptisoCrossedEdges", "number", ["number"], [request.isovalue]) as number });
  }
  await put(instance.FS, request.file);
  try {
    const facts = call(instance, "adaptisoOpenMesh", ["string", "string"], [request.file.path, request.program]);
    const shape = shapeOf(instance, facts);
    const opened: OpenedMesh = { shape, format: facts.format as string, frame: facts.frame as string | null,
      valuesName: facts.values as string | null };
    reply({ id, kind: "done", result: opened }, buffersOf(shape));
  } finally {
    instance.FS.unlink(request.file.path);
  }
}

self.addEventListener("message", async (event: MessageEvent<Message>) => {
  const { id, request } = event.data;
  module = event.data.module ?? module;
  try {
    await handle(id, request);
  } catch (error) {
    const isRefusal = error instanceof Refusal;
    reply({ id, kind: "refused", exitCode: isRefusal ? error.exitCode : 4, series: isRefusal ? error.series : [],
      volumes: isRefusal ? error.volumes : null,
      line: isRefusal ? error.line : `the page failed: ${error instanceof Error ? error.message : error}` });
  }
});
