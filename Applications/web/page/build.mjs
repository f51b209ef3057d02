// Bundles the page into one file: node build.mjs BUILD-FOLDER VERSION, where BUILD-FOLDER holds adaptiso.js and
// adaptiso.wasm.
import { createHash } from "node:crypto";
import { readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { gzipSync } from "node:zlib";
import { build } from "esbuild";

const [folder, version] = process.argv.slice(2);
const here = import.meta.dirname ?? new URL(".", import.meta.url).pathname;

async function bundle(entry, format, options = {}) {
  const result = await build({ entryPoints: [join(here, entry)], bundle: true, minify: true, write: false, format,
    target: "es2022", legalComments: "none", define: { __VERSION__: JSON.stringify(version) }, ...options });
  return result.outputFiles[0].text.replaceAll('"__VERSION__"', JSON.stringify(version));
}

/** niivue carries the codecs of Zarr as WebAssembly in base64, more than half of it. It reads no Zarr here. */
const withoutCodecs = { name: "withoutCodecs", setup: (bundler) => bundler.onLoad({ filter: /niivue\/dist\/index\.js$/ }, ({ path }) =>
  ({ contents: read(path).toString().replace(/__toBinary\("[^"]*"\)/g, '__toBinary("")') })) };

const packed = (bytes) => gzipSync(bytes, { level: 9 }).toString("base64");
const read = (path) => readFileSync(path);
const inScript = (text) => text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");

/** What the programs in WebAssembly offer to choose from. */
async function choices() {
  const programs = await createRequire(import.meta.url)(resolve(folder, "adaptiso.js"))({ wasmBinary: read(join(folder, "adaptiso.wasm")) });
  programs.ccall("adaptisoChoices", "number", [], []);
  return JSON.parse(programs.ccall("adaptisoAnswer", "string", [], []));
}
const { formats, presets } = await choices();
const formatOptions = (chosen) => formats.map(({ name, extension }) =>
  `<option value="${extension}"${extension === chosen ? " selected" : ""}>${name}</option>`).join("");

/** An option's default in words, of the package's types, which are made from the programs; `%`: its share alone. */
const types = read(join(here, "../npm/options.d.ts")).toString();
function defaultOf(program, option, isShare) {
  const words = new RegExp(`interface ${program}Rows[^}]*?default: ([^\\n]*?)\\)\\. \\*/ ${option}\\?`).exec(types)[1];
  return isShare ? /^[\d.]+ %/.exec(words)[0] : words;
}

const kRun = `<div class="progress" hidden><p class="stage" aria-live="polite"></p><progress max="100" aria-label="Progress"></progress>
      <button type="button" class="cancel">Cancel</button></div>
    <p class="refusal" role="alert" hidden></p><div class="choices row"></div><div class="result" hidden></div>`;
const worker = `${read(join(folder, "adaptiso.js"))}\n${await bundle("src/worker.ts", "iife")}`;
const niivue = inScript(await bundle("node_modules/@niivue/niivue/dist/index.js", "iife", { globalName: "niivue", plugins: [withoutCodecs] }));
const script = inScript(await bundle("src/main.ts", "iife"));
const parts = {
  STYLE: read(join(here, "src/page.css")).toString(),
  RUN: kRun,
  FORMATS: formatOptions(".vtp"),
  FORMATSTOPRINT: formatOptions(".stl"),
  EXTENSIONS: formats.map(({ extension }) => extension).join(", "),
  PRESETS: presets.map((name) => `<option>${name}</option>`).join(""),
  WASM: packed(read(join(folder, "adaptiso.wasm"))),
  WORKER: packed(worker),
  NIIVUE: packed(niivue),
  SCRIPT: script,
  HASHES: [script, niivue].map((text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`).join(" "),
};
const page = read(join(here, "src/page.html")).toString()
  .replace(/\{\{DEFAULT (\w+) (\w+)( %)?\}\}/g, (_, program, option, isShare) => defaultOf(program, option, isShare))
  .replace(/\{\{WHY (.*?): (.*?)\}\}/g, `<details class="why" name="why"><summary aria-label="About $1">?</summary><p>$2</p></details>`)
  .replace(/\{\{([A-Z]+)\}\}/g, (_, name) => parts[name]);
writeFileSync(join(folder, "adaptiso.html"), page);
console.log(`${join(folder, "adaptiso.html")}: ${(page.length / 1e6).toFixed(2)} MB`);
for (const [name, text] of Object.entries(parts)) console.log(`  ${name}: ${(text.length / 1e6).toFixed(2)} MB`);
