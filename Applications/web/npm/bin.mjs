#!/usr/bin/env node
// The programs of adaptiso on this machine's files: `adaptiso mesh scan.nii.gz --iso 100` is adaptiso-mesh.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { isatty } from "node:tty";

const createAdaptiso = createRequire(import.meta.url)("./adaptiso-node.cjs");
const instance = await createAdaptiso({
  wasmBinary: readFileSync(new URL("./adaptiso.wasm", import.meta.url)),
  thisProgram: "adaptiso",
  preRun: [({ ENV }) => Object.assign(ENV, process.env)],
  quit: (status) => process.exit(status),
});
for (const stream of instance.FS.streams.slice(0, 3)) stream.tty = isatty(stream.fd);
process.exit(instance.callMain(process.argv.slice(2)));
