// Runs one program in one instance of the WebAssembly, on files in memory: in a Web Worker, or a thread of Node.
import createAdaptiso from "./adaptiso.mjs";

const kFolder = "/work";

function filesBelow(fs, folder) {
  return fs.readdir(folder).filter((name) => name !== "." && name !== "..").sort().flatMap((name) => {
    const path = folder === "." ? name : `${folder}/${name}`;
    return fs.isDir(fs.stat(path).mode) ? filesBelow(fs, path) : [path];
  });
}

async function run({ module, program, args, files, folders }, send) {
  const stdout = [], stderr = [];
  const instance = await new Promise((resolve, reject) => createAdaptiso({
    thisProgram: `adaptiso-${program}`,
    print: (line) => stdout.push(line),
    printErr: (line) => stderr.push(line),
    onProgress: (text) => send({ progress: text }),
    instantiateWasm: (imports, done) => {
      WebAssembly.instantiate(module, imports).then(done).catch(reject);  // which the glue waits for without end
      return {};
    },
    quit: (_status, thrown) => { throw thrown; },
  }).then(resolve, reject));
  const { FS } = instance;
  FS.mkdirTree(kFolder);
  FS.chdir(kFolder);
  for (const folder of folders) FS.mkdirTree(`${kFolder}/${folder}`);
  for (const { path, bytes } of files) {
    FS.mkdirTree(`${kFolder}/${path}`.replace(/\/[^/]*$/, ""));
    FS.writeFile(path, bytes, { canOwn: true });
  }
  const given = new Set(files.map((file) => file.path));
  const exitCode = instance.callMain(args);
  const made = filesBelow(FS, ".").filter((path) => !given.has(path))
    .map((path) => ({ path, bytes: FS.readFile(path) }));
  send({ result: { exitCode, stdout: stdout.join("\n"), stderr: stderr.join("\n"), files: made,
    memoryBytes: instance.HEAPU8.length } }, made.map((file) => file.bytes.buffer));
}

async function serve(job, send) {
  try {
    await run(job, send);
  } catch (error) {
    send({ failure: String(error?.message ?? error) });
  }
}

async function serveThread() {
  const { parentPort } = await import("node:worker_threads"), { createRequire } = await import("node:module");
  globalThis.require = createRequire(import.meta.url);  // which Emscripten's glue takes for granted
  globalThis.__dirname = "";
  parentPort.once("message", (data) => serve(data, (message, transfer = []) => parentPort.postMessage(message, transfer)));
}

if (typeof self === "object" && typeof self.postMessage === "function") {
  self.onmessage = ({ data }) => serve(data, (message, transfer = []) => self.postMessage(message, transfer));
} else {
  serveThread();  // not awaited: bundlers make workers that know no top-level await
}
