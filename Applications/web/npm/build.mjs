// Makes the npm package of what CMake built: node build.mjs BUILD-FOLDER VERSION; BUILD-FOLDER/npm/adaptiso-VERSION.tgz.
import { execFileSync } from "node:child_process";
import { copyFileSync, mkdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const [build, version] = process.argv.slice(2);
const here = dirname(fileURLToPath(import.meta.url)), folder = join(build, "npm", "adaptiso");
rmSync(join(build, "npm"), { recursive: true, force: true });
mkdirSync(folder, { recursive: true });
for (const name of ["README.md", "bin.mjs", "index.mjs", "index.d.ts", "options.d.ts", "niivue.mjs", "niivue.d.ts", "worker.mjs"]) copyFileSync(join(here, name), join(folder, name));
copyFileSync(join(here, "../../../LICENSE"), join(folder, "LICENSE"));
const read = (name) => readFileSync(join(build, name));
if (!read("adaptiso.wasm").equals(read("adaptiso-node.wasm"))) throw new Error("adaptiso.wasm and adaptiso-node.wasm differ");
writeFileSync(join(folder, "adaptiso.wasm"), read("adaptiso.wasm"));
writeFileSync(join(folder, "adaptiso-node.cjs"), read("adaptiso-node.js"));
writeFileSync(join(folder, "adaptiso.mjs"), `${read("adaptiso.js")}\nexport default createAdaptiso;\n`);
writeFileSync(join(folder, "package.json"), JSON.stringify({ ...JSON.parse(readFileSync(join(here, "package.json"))), version }, null, 2));
console.log(execFileSync("npm", ["pack", "--silent", "--pack-destination", ".."], { cwd: folder, encoding: "utf8" }).trim());
