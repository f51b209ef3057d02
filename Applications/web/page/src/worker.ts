/**
 * A worker runs one program in one instance of the WebAssembly, as a process does, or keeps one to look
 * at an image. The glue that Emscripten made stands above this code and defines createAdaptiso().
 */
import type { Message, OpenedImage, OpenedMesh, OpenRequest, OutputFile, Reply, RunRequest, RunResult,
  Shape, InputFile } from "./protocol";

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
  const instance = await createAdaptiso({
    ...options,
    instantiateWasm: (imports: WebAssembly.Imports, done: (instance: WebAssembly.Instance) => void) => {
      WebAssembly.instantiate(module, imports).then(done);
      return {};
    },
    quit: (_status: number, thrown: unknown) => { throw thrown; },
  });
  instance.FS.mkdirTree(kFolder);
  instance.FS.chdir(kFolder);
  return instance;
}

async function bytesOf(data: Blob | Uint8Array): Promise<Uint8Array> {
  return data instanceof Uint8Array ? data : new Uint8Array(await data.arrayBuffer());
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
  const stdout: string[] = [], stderr: string[] = [];
  const instance = await makeInstance({
    thisProgram: request.program,
    print: (line: string) => stdout.push(line),
    printErr: (line: string) => stderr.push(line),
    onProgress: (text: string) => reply({ id, kind: "progress", text }),
  });
  for (const folder of request.folders) instance.FS.mkdirTree(`${kFolder}/${folder}`);
  for (const file of request.files) await put(instance.FS, file);
  const given = new Set(request.files.map((file) => file.path));
  const begin = performance.now();
  const exitCode = instance.callMain(request.args);
  const seconds = (performance.now() - begin) / 1000;
  const files: OutputFile[] = listFiles(instance.FS, ".").filter((path) => !given.has(path))
    .map((path) => ({ path, bytes: instance.FS.readFile(path) }));
  const result: RunResult = { exitCode, stdout: stdout.join("\n"), stderr: stderr.join("\n"), files,
    memoryBytes: instance.HEAPU8.length, seconds };
  reply({ id, kind: "done", result }, files.map((file) => file.bytes.buffer));
}

const answerOf = (instance: Instance): string => instance.ccall("adaptisoAnswer", "string", [], []) as string;

/** \throws Refusal */
class Refusal extends Error {
  constructor(readonly line: string, readonly exitCode: number) { super(line); }
}

function call(instance: Instance, name: string, types: string[], args: unknown[]): Record<string, unknown> {
  const exitCode = instance.ccall(name, "number", types, args) as number;
  const answer = answerOf(instance);
  if (exitCode !== 0) throw new Refusal(answer, exitCode);
  return JSON.parse(answer);
}

const address = (instance: Instance, name: string): number =>
  instance.ccall(name, "number", [], []) as number >>> 0;

function shapeOf(instance: Instance, points: number, triangles: number, hasValues: boolean): Shape {
  const from = address(instance, "adaptisoPoints") / 4, corners = address(instance, "adaptisoTriangles") / 4;
  const values = address(instance, "adaptisoValues") / 4;
  return {
    points: instance.HEAPF32.slice(from, from + 3 * points),
    triangles: instance.HEAPU32.slice(corners, corners + 3 * triangles),
    values: hasValues ? instance.HEAPF32.slice(values, values + points) : null,
  };
}

function pointCount(triangles: Uint32Array): number {
  let most = -1;
  for (const corner of triangles) if (corner > most) most = corner;
  return most + 1;
}

async function open(request: OpenRequest): Promise<OpenedImage> {
  const instance = await makeInstance({ print: () => {}, printErr: () => {} });
  looker = Promise.resolve(instance);
  for (const file of request.files) await put(instance.FS, file);
  const facts = call(instance, "adaptisoOpenImage", ["string", "number", "string", "number"],
    [request.path, request.volumeIndex, request.series, request.isLabels ? 1 : 0]);
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
    const facts = call(instance, "adaptisoPreview", ["number"], [request.isovalue]);
    const shape = shapeOf(instance, 0, facts.triangles as number, false);
    const from = address(instance, "adaptisoPoints") / 4;
    shape.points = instance.HEAPF32.slice(from, from + 3 * pointCount(shape.triangles));
    return reply({ id, kind: "done", result: shape }, [shape.points.buffer, shape.triangles.buffer]);
  }
  await put(instance.FS, request.file);
  try {
    const facts = call(instance, "adaptisoOpenMesh", ["string", "string"], [request.file.path, request.program]);
    const shape = shapeOf(instance, facts.points as number, facts.triangles as number, facts.values !== null);
    const opened: OpenedMesh = { shape, format: facts.format as string, frame: facts.frame as string | null,
      valuesName: facts.values as string | null };
    reply({ id, kind: "done", result: opened });
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
    reply({ id, kind: "refused", exitCode: isRefusal ? error.exitCode : 4,
      line: isRefusal ? error.line : `the page failed: ${error instanceof Error ? error.message : error}` });
  }
});
