import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { after, before, describe, it } from "node:test";
import { gunzipSync, gzipSync } from "node:zlib";
import { build } from "esbuild";
import validator from "gltf-validator";
import { arrived, balls, choicesOf, dicomSlice, ended, give, headLabels, kBrowsers, kPage, makeFolder, native, openPage, picture, press, saved,
  textOf, writeNifti } from "./support.mjs";

/** By which limits of time, those of a quiet machine, are multiplied: CI tests two browsers at once, with modules made quickly. */
const kPatience = process.env.ADAPTISO_WEB_QUICK ? 5 : 1;

const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

/** Files of a ZIP archive that are stored as they are. */
function unzip(bytes) {
  const files = new Map();
  for (let at = 0; bytes.readUInt32LE(at) === 0x04034b50;) {
    const size = bytes.readUInt32LE(at + 18), name = bytes.readUInt16LE(at + 26), begin = at + 30 + name;
    files.set(bytes.toString("utf8", at + 30, begin), bytes.subarray(begin, begin + size));
    at = begin + size;
  }
  return files;
}

describe("the file", () => {
  it("is one of 4 MB at most that forbids itself to connect", () => {
    const text = readFileSync(kPage, "utf8");
    const most = process.env.ADAPTISO_WEB_QUICK ? 4.4e6 : 4e6;  // linked quickly, it is a tenth larger
    assert.ok(text.length <= most, `${text.length} bytes`);
    const policy = /Content-Security-Policy" content="([^"]*)"/.exec(text)[1];
    assert.match(policy, /default-src 'none'/);
    assert.match(policy, /connect-src data: blob:(;|$)/);
    assert.match(policy, /webrtc 'block'/);
  });

  it("lets its own scripts run alone, by their checksums", () => {
    const text = readFileSync(kPage, "utf8");
    const allowed = /script-src ([^;]*);/.exec(text)[1].split(" ");
    const niivue = gunzipSync(Buffer.from(/<script type="text\/plain" id="niivue">([^<]*)</.exec(text)[1], "base64"));
    const scripts = [/<script>([\s\S]*)<\/script>\n<\/body>/.exec(text)[1], niivue];
    assert.deepEqual(allowed, [...scripts.map((script) => `'sha256-${createHash("sha256").update(script).digest("base64")}'`), "'wasm-unsafe-eval'"]);
    assert.doesNotMatch(text.replace(/<script[\s\S]*<\/script>/, ""), /<[a-z][^>]*\son[a-z]+=/);
  });
});

describe("a mesh", async () => {
  const { outputFiles: [{ text }] } = await build({ entryPoints: [new URL("../src/shape.ts", import.meta.url).pathname], bundle: true, write: false, format: "esm" });
  const { countPieces, insideOf } = await import(`data:text/javascript,${encodeURIComponent(text)}`);
  /** Boxes from [x, half a side], turned inside out where that is negative. */
  const boxes = (...places) => {
    const points = [], triangles = [], normals = [];
    for (const [x, half] of places) {
      const sides = [0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5].map((n) => n + points.length / 3);
      triangles.push(...sides);
      for (let n = 0; n < 8; ++n) {
        const corner = [n & 1, n >> 1 & 1, n >> 2].map((side) => 2 * side - 1);
        points.push(...corner.map((side, axis) => (axis === 0 ? x : 0) + side * Math.abs(half)));
        normals.push(...corner.map((side) => side * half));
      }
    }
    return { points: Float32Array.from(points), triangles: Uint32Array.from(triangles), normals: Float32Array.from(normals) };
  };
  it("has pieces and cavities", () => {
    assert.deepEqual(countPieces(boxes([0, 4], [0, -2], [0, 1], [9, 2])), { pieces: 3, cavities: 1 });
  });
  it("has an inside, also beneath its corners, edges and diagonals", () => {
    const isInside = insideOf(boxes([0, 4], [0, 2], [9, 2]));  // the inner one is a hole by its count
    for (const [x, y, z, inside] of [[3, 3, 3, true], [0, 0, 0, false], [2, 2, -3, true], [0, 0, 3, true], [4.5, 0, 0, false], [9, 1, -1, true],
      [9, 0, 2.5, false], [-4, -4, -5, false], [50, 0, 0, false]]) assert.equal(isInside(x, y, z), inside, `${x}, ${y}, ${z}`);
  });
});

for (const browserName of kBrowsers) {
  // minutes of the same module: with ADAPTISO_WEB_QUICK in one browser
  const itOnce = process.env.ADAPTISO_WEB_QUICK && browserName !== "chrome" ? it.skip : it;
  describe(`the page in ${browserName}`, () => {
    let open, page, folder;
    before(async () => {
      open = await openPage(browserName);
      ({ page } = open);
      folder = makeFolder();
      writeNifti(join(folder, "balls.nii"), [48, 48, 48], balls);
    });
    after(async () => {
      await open.browser.close();
      assert.deepEqual(open.requests, [], "requests left the page");
      assert.deepEqual(open.errors, []);
    });

    it("shows a result of the example by one click", async () => {
      await page.evaluate(() => {
        const caption = document.querySelector("#caption");
        globalThis.captions = [];
        new MutationObserver(() => globalThis.captions.push(caption.textContent)).observe(caption, { childList: true });
      });
      await press(page, "#example");
      assert.equal(await ended(page, "mesh"), "");
      assert.match(await textOf(page, "#mesh .verdict"), /^[\d,]+ triangles; no point farther than 0\.(3|29\d) mm from the isosurface at [\d.]{1,5} of the scan \(proved\); closed; no triangles cross; 1 piece$/);
      assert.match(await textOf(page, "#largest-drops"), /^drops \d+ smaller$/);
      assert.match(await textOf(page, "#fill-drops"), /^drops \d+$/);
      await page.waitForFunction(() => document.body.dataset.shown === "example.stl", { timeout: 60_000 });
      assert.deepEqual(await page.evaluate(() => globalThis.captions.slice(-2)), ["drawing ...", "example.stl "]);
      await picture(page, `${browserName}-example`);
    });

    it("runs no script that is put in", async () => {
      const wasRun = await page.evaluate(async () => {
        const script = document.createElement("script");
        script.textContent = "globalThis.wasRun = true";
        document.body.append(script);
        const image = document.createElement("img");
        image.setAttribute("onerror", "globalThis.wasRun = true");
        image.src = "data:,";
        await new Promise((done) => setTimeout(done, 300));
        script.remove();
        return globalThis.wasRun ?? false;
      });
      assert.equal(wasRun, false);
      open.errors.splice(0);  // what the browser says of it
    });

    it("opens gzip of several members, the last empty, as BGZF is", async () => {
      const bytes = readFileSync(join(folder, "balls.nii"));
      const members = [bytes.subarray(0, 40000), bytes.subarray(40000), Buffer.alloc(0)].map((part) => gzipSync(part));
      writeFileSync(join(folder, "members.nii.gz"), Buffer.concat(members));
      await give(page, "#scan-files", join(folder, "members.nii.gz"));
      await page.waitForFunction(() => document.body.dataset.scan === "members.nii.gz", { timeout: 60_000 });
    });

    it("shows a preview within a second that follows the slider", async () => {
      writeNifti(join(folder, "head.nii"), [181, 217, 181], (i, j, k) => balls(i % 64, j % 64, k % 64));
      await give(page, "#scan-files", join(folder, "head.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "head.nii", { timeout: 120_000 });
      const shown = [];
      for (const isovalue of [90, 120, 150, 110]) {
        shown.push(await page.evaluate(async (value) => {
          const preview = document.querySelector("#preview"), slider = document.querySelector("#iso-slider");
          for (const passing of [60, 200, value]) {  // wishes that came too late are left out
            slider.value = String(passing);
            slider.dispatchEvent(new Event("input"));
          }
          const begin = performance.now();
          const wanted = document.querySelector("#iso").value;
          while (preview.dataset.isovalue !== wanted && performance.now() - begin < 60_000) await new Promise((done) => setTimeout(done, 5));
          return { seconds: (performance.now() - begin) / 1000, text: preview.textContent };
        }, isovalue));
      }
      assert.equal(new Set(shown.map(({ text }) => text)).size, 4, JSON.stringify(shown));
      const [, seconds] = shown.map((each) => each.seconds).sort((a, b) => a - b);  // 0.1 to 0.4 on a busy machine
      assert.ok(seconds < kPatience, JSON.stringify(shown));
    });

    it("offers the programs' formats and presets", async () => {
      const offeredBy = (program, option) => new RegExp(`\\n  --${option} (\\S+)`).exec(native(folder, program, "--help").stdout)[1].split("|");
      const formats = offeredBy("adaptiso-labels", "format").map((word) => `.${word}`);
      for (const form of ["#format", "#mend-format", "#simplify-format", "#labels-format"]) assert.deepEqual(await choicesOf(page, form), formats, form);
      assert.deepEqual(await choicesOf(page, "#preset"), ["", ...offeredBy("adaptiso-bem", "preset")]);
    });

    it("saves the bytes that the program writes, in every format", async () => {
      await give(page, "#scan-files", join(folder, "balls.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "balls.nii");
      for (const format of await choicesOf(page, "#format")) {
        await page.select("#format", format);
        await press(page, "#mesh .go");
        assert.equal(await ended(page, "mesh"), "");
        const bytes = await saved(page, open.downloads, "#mesh .saves .main", `balls${format}`);
        const command = (await textOf(page, "#mesh .copy:nth-of-type(2) code")).split(" ");
        assert.equal(native(folder, ...command).status, 0, command.join(" "));
        assert.deepEqual(bytes, readFileSync(join(folder, `balls${format}`)), format);
        const verdict = await textOf(page, "#mesh .copy code");
        assert.ok(verdict.includes(createHash("sha256").update(bytes).digest("hex")), verdict);
      }
    });

    it("saves a GLB that the Khronos validator takes, in metres", async () => {
      const bytes = await saved(page, open.downloads, "#mesh .saves button:nth-of-type(3)", "balls.glb");
      const { issues, info } = await validator.validateBytes(new Uint8Array(bytes));
      assert.deepEqual(issues.messages, []);
      assert.equal(info.totalTriangleCount, Number((await textOf(page, "#mesh .verdict")).split(" ")[0].replaceAll(",", "")));
      const { nodes } = JSON.parse(bytes.toString("utf8", 20, 20 + bytes.readUInt32LE(12)));
      assert.deepEqual(nodes[0].scale, [0.001, 0.001, 0.001]);
      assert.equal(nodes[1].name, "balls.3mf");
    });

    itOnce("makes the same bytes with every option of the form", async () => {
      await give(page, "#scan-files", join(folder, "balls.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "balls.nii");
      await page.select("#format", ".ply");
      await page.select("#frame", "lps");
      for (const id of ["#by-count", "#largest"]) await press(page, id);
      assert.deepEqual(await page.$$eval("#max-error, #triangles", (inputs) => inputs.map(({ disabled }) => disabled)), [true, false]);
      await page.$eval("#triangles", (input) => { input.value = "3,000"; });
      await page.$eval("#smooth", (input) => { input.value = "0.8"; });
      await press(page, "#mesh .go");
      assert.equal(await ended(page, "mesh"), "");
      const bytes = await saved(page, open.downloads, "#mesh .saves .main", "balls.ply");
      const command = (await textOf(page, "#mesh .copy:nth-of-type(2) code")).split(" ");
      assert.deepEqual(command.filter((word) => word.startsWith("--")), ["--iso", "--smooth", "--triangles", "--fill-cavities", "--coordinates", "--json"]);
      assert.equal(native(folder, ...command).status, 0);
      assert.deepEqual(bytes, readFileSync(join(folder, "balls.ply")));
      assert.match(await textOf(page, "#mesh .verdict"), /mm from the isosurface at [\d.]+ of the scan smoothed by 0\.8 mm \(proved\)/);
      for (const id of ["#by-distance", "#largest"]) await press(page, id);
      await page.$eval("#smooth", (input) => { input.value = ""; });
    });

    it("keeps scan, form and result where another file is refused", async () => {
      writeFileSync(join(folder, "notes.txt"), "no scan");
      const facts = await textOf(page, "#facts"), verdict = await textOf(page, "#mesh .verdict");
      await give(page, "#scan-files", join(folder, "notes.txt"));
      await page.waitForFunction(() => !document.querySelector("#mesh .refusal").hidden, { timeout: 60_000 });
      assert.equal(await textOf(page, "#facts"), facts);
      assert.equal(await textOf(page, "#mesh .verdict"), verdict);
      assert.ok(await page.$eval("#mesh .saves .main", (button) => button.checkVisibility()));
      assert.equal(await page.$eval("#mesh-options", (set) => set.disabled), false);
      await press(page, "#mesh .go");  // of the scan that is still there
      assert.equal(await ended(page, "mesh"), "");
    });

    it("takes a decimal comma for no other number", async () => {
      for (const [field, option] of [["#iso", "--iso"], ["#max-error", "--max-error"]]) {
        const before = await page.$eval(field, (input) => input.value);
        await page.$eval(field, (input) => { input.value = ""; });
        await page.type(field, "0,5");
        await press(page, "#mesh .go");
        assert.match(await ended(page, "mesh"), new RegExp(`^adaptiso-mesh: ${option} 0,5: decimals follow a point`));
        await page.$eval(field, (input, value) => { input.value = value; }, before);
      }
      await press(page, "#mesh .go");
      assert.equal(await ended(page, "mesh"), "");
    });

    it("says of two scans that they are two", async () => {
      writeNifti(join(folder, "other.nii"), [8, 8, 8], (i) => i);
      await give(page, "#scan-files", join(folder, "balls.nii"), join(folder, "other.nii"));
      await page.waitForFunction(() => !document.querySelector("#mesh .refusal").hidden, { timeout: 60_000 });
      assert.match(await textOf(page, "#mesh .refusal"), /^balls\.nii and other\.nii are 2 scans: give one here/);
      // a sidecar is none
      writeFileSync(join(folder, "balls.json"), "{}");
      await give(page, "#scan-files", join(folder, "balls.nii"), join(folder, "balls.json"));
      await page.waitForFunction(() => document.querySelector("#mesh .refusal").hidden && document.body.dataset.scan === "balls.nii", { timeout: 60_000 });
    });

    it("says what to do where a line names an option that the page has not", async () => {
      const slices = [];
      for (const n of [0, 1, 2, 5, 6]) {
        slices.push(join(folder, `uneven-${n}.dcm`));
        writeFileSync(slices.at(-1), dicomSlice(3, n, 6));
      }
      await give(page, "#scan-files", ...slices);
      await page.waitForFunction(() => /--resample-slices/.test(document.querySelector("#mesh .refusal").textContent), { timeout: 60_000 });
      assert.match(await textOf(page, "#mesh .choices"), /^Not possible in this page: npx adaptiso mesh \.\.\. --resample-slices$/);
    });

    it("refuses what the programs refuse, with the same line", async () => {
      writeFileSync(join(folder, "empty.nii"), "");
      writeFileSync(join(folder, "cut.nii"), readFileSync(join(folder, "balls.nii")).subarray(0, 20_000));
      writeFileSync(join(folder, "page.nii.gz"), "<!DOCTYPE html><html><body>404</body></html>");
      writeNifti(join(folder, "four.nii"), [6, 6, 6, 3], () => 1);
      writeNifti(join(folder, "rgb.nii"), [6, 6, 6], () => 1, [[70, "Int16LE", 128], [72, "Int16LE", 24]], 3);
      writeNifti(join(folder, "singular.nii"), [6, 6, 6], () => 1, [[280, "FloatLE", 0]]);
      for (const name of ["empty.nii", "cut.nii", "page.nii.gz", "four.nii", "rgb.nii", "singular.nii"]) {
        await page.$eval("#mesh .refusal", (element) => { element.hidden = true; element.textContent = ""; });
        await give(page, "#scan-files", join(folder, name));
        await page.waitForFunction(() => document.querySelector("#mesh .refusal").hidden === false, { timeout: 60_000 });
        const { status, line } = native(folder, "adaptiso-mesh", name, "--iso", "1", "-o", "x.stl");
        assert.equal(status, 3, name);
        assert.equal(await textOf(page, "#mesh .refusal"), line);
      }
    });

    it("offers the volumes of a 4-D image and the series of a folder to choose from", async () => {
      const isOpen = (text) => page.waitForFunction((part) => !document.querySelector("#facts-box").hidden
        && document.querySelector("#facts").textContent.includes(part), { timeout: 60_000 }, text);
      writeNifti(join(folder, "two.nii"), [8, 8, 8, 2], (i, _j, _k, volume) => 10 * volume + (i > 3));
      await give(page, "#scan-files", join(folder, "two.nii"));
      await page.waitForSelector("#mesh .choices button", { timeout: 60_000 });
      await page.$eval("#mesh .choices input", (input) => { input.value = "1"; });
      await press(page, "#mesh .choices button");
      await isOpen("values 10 to 11");
      await press(page, "#mesh .go");
      assert.equal(await ended(page, "mesh"), "");
      assert.match(await textOf(page, "#mesh .copy:nth-of-type(2) code"), /--volume-index 1/);

      const slices = [];
      for (const [series, size] of [[1, 6], [2, 9]]) {
        for (let n = 0; n < size; ++n) {
          slices.push(join(folder, `${series}-${n}.dcm`));
          writeFileSync(slices.at(-1), dicomSlice(series, n, size));
        }
      }
      await give(page, "#scan-files", ...slices);
      await page.waitForSelector("#mesh .choices button", { timeout: 60_000 });
      assert.equal((await page.$$("#mesh .choices button")).length, 2);
      assert.equal(await page.$eval("#mesh .refusal", (box) => box.hidden), true);  // it is a question
      assert.deepEqual(await page.$$eval("#mesh .choices button", (buttons) => buttons.map(({ textContent }) => textContent)),
        ["1: MR, series 1; 6 slices, 1 × 1 × 1 mm", "2: MR, series 2; 9 slices, 1 × 1 × 1 mm"]);
      await press(page, "#mesh .choices button:nth-of-type(2)");
      await isOpen("9 × 9 × 9 voxels");
    });

    it("takes what is dropped beside a zone, for the tab that is seen", async () => {
      await press(page, "#tab-head");
      await page.evaluate((bytes) => {
        const data = new DataTransfer();
        data.items.add(new File([Uint8Array.from(bytes)], "dropped.nii"));
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: data, bubbles: true, cancelable: true }));
      }, [...readFileSync(join(folder, "balls.nii"))]);
      await page.waitForFunction(() => document.querySelector("#head-scan").textContent === "dropped.nii", { timeout: 60_000 });
      await press(page, "#tab-mesh");
      assert.match(await textOf(page, "#facts"), /^dropped\.nii: NIfTI-1, 48 × 48 × 48 voxels/);
    });

    it("draws the outlines of noise without freezing", async () => {
      writeNifti(join(folder, "noise.nii"), [256, 256, 4], (i, j, k) => Math.imul(i + 256 * j + 65536 * k + 1, 2654435761) >>> 24);
      await give(page, "#scan-files", join(folder, "noise.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "noise.nii"  // a 2-D canvas took a minute
        && document.querySelector("#preview").dataset.isovalue === document.querySelector("#iso").value, { timeout: kPatience * 30_000 });
      await picture(page, `${browserName}-noise`);
    });

    it("refuses what no memory of a page holds before it reads it", async () => {
      // 4,000 megabytes of zeros by gzip's own record of its length
      const bytes = Buffer.concat([Buffer.from([0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3]), Buffer.alloc(100)]);
      bytes.writeUInt32LE(4_000_000_000, bytes.length - 4);
      writeFileSync(join(folder, "huge.nii.gz"), bytes);
      await give(page, "#scan-files", join(folder, "huge.nii.gz"));
      await page.waitForFunction(() => !document.querySelector("#mesh .refusal").hidden);
      assert.match(await textOf(page, "#mesh .refusal"), /^huge\.nii\.gz needs about 4\.0 GB of memory, and a page has 4 GB: use adaptiso-mesh/);
    });

    it("refuses a surface that no memory of a page holds before it makes it", async () => {
      // all neighbours differ: 3 x 192 x 160 x 160 edges, 280 bytes each
      writeNifti(join(folder, "rough.nii"), [192, 160, 160], (i, j, k) => 255 * ((i + j + k) & 1));
      await give(page, "#scan-files", join(folder, "rough.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "rough.nii", { timeout: 120_000 });
      await press(page, "#mesh .go");
      await page.waitForFunction(() => !document.querySelector("#mesh .refusal").hidden, { timeout: 60_000 });
      assert.match(await textOf(page, "#mesh .refusal"), /^rough\.nii needs about 4\.2 GB of memory, and a page has 4 GB: use adaptiso-mesh$/);
    });

    it("estimates what a run takes", async () => {
      const memory = (tab) => page.$eval(`#${tab}`, ({ dataset }) => [dataset.estimatedBytes, dataset.memoryBytes].map(Number));
      // below 20 MB nothing grows; a heap grows by a fifth at once
      writeNifti(join(folder, "waves.nii"), [128, 128, 128], (i, j, k) => 128 + 100 * Math.sin(i / 3) * Math.sin(j / 3) * Math.sin(k / 3));
      await give(page, "#scan-files", join(folder, "waves.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "waves.nii", { timeout: 120_000 });
      for (const [smooth, least, most] of [["", 0.75, 1.3], ["1.5", 0.75, 2]]) {  // fewer edges are left of what is smoothed
        await page.$eval("#smooth", (input, mm) => { input.value = mm; }, smooth);
        await press(page, "#mesh .go");
        assert.equal(await ended(page, "mesh"), "");
        const [estimated, taken] = await memory("mesh");
        assert.ok(estimated > least * taken && estimated < most * taken, `${smooth}: ${estimated} for ${taken} bytes`);
      }
      await page.$eval("#smooth", (input) => { input.value = ""; });
    });

    it("cancels within 0.2 s, and makes the mesh again", async () => {
      writeNifti(join(folder, "large.nii"), [160, 160, 160], (i, j, k) => balls(i % 48, j % 48, k % 48));
      await give(page, "#scan-files", join(folder, "large.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "large.nii", { timeout: 120_000 });
      await press(page, "#mesh .go");
      await page.waitForFunction(() => document.querySelector("#mesh .stage").textContent !== "start", { timeout: 120_000 });
      const milliseconds = await page.evaluate(async () => {
        const begin = performance.now();
        document.querySelector("#mesh .cancel").click();
        while (document.querySelector("#mesh .go").disabled) await new Promise((done) => setTimeout(done, 5));
        return performance.now() - begin;
      });
      assert.ok(milliseconds < kPatience * 200, `${milliseconds} ms`);
      await press(page, "#mesh .go");  // a scan that is opened in another tab ends its run, too
      await press(page, "#tab-labels");
      await give(page, "#labels-file", join(folder, "balls.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "balls.nii", { timeout: 120_000 });
      assert.match(await ended(page, "mesh"), /^Cancelled/);
      await press(page, "#tab-mesh");
      await give(page, "#scan-files", join(folder, "balls.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "balls.nii", { timeout: 120_000 });
      await press(page, "#mesh .go");
      assert.equal(await ended(page, "mesh"), "");
    });

    itOnce("makes a head model of labels: the program's files", async () => {
      writeNifti(join(folder, "seg.nii"), [85, 85, 85], headLabels,
        [280, 300, 320].map((at) => [at, "FloatLE", 2]).concat([[80, "FloatLE", 2], [84, "FloatLE", 2], [88, "FloatLE", 2]]));
      await press(page, "#tab-mesh");
      await give(page, "#scan-files", join(folder, "seg.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "seg.nii", { timeout: 120_000 });
      await press(page, "#tab-head");
      await page.select("#source", "labels");
      await page.$eval("#tissues", (input) => { input.value = "brain=1 skull=2 scalp=3"; });
      await page.$eval("#vertices", (input) => { input.value = "642"; });
      await press(page, "#head .go");
      assert.equal(await ended(page, "head", 600_000), "");
      const files = unzip(await saved(page, open.downloads, "#head .saves .main", "model.zip"));
      const command = (await textOf(page, "#head .copy:nth-of-type(2) code")).split(" ");
      assert.equal(native(folder, ...command).status, 0);
      for (const name of ["inner_skull.surf", "outer_skull.surf", "outer_skin.surf", "bem.fif", "model.geom", "inner_skull.tri"]) {
        assert.deepEqual(files.get(`model/${name}`), readFileSync(join(folder, "model", name)), name);
      }
      await picture(page, `${browserName}-head`);
    });

    itOnce("makes all regions of labels: the program's files", async () => {
      await press(page, "#tab-labels");
      await give(page, "#labels-file", join(folder, "seg.nii"));
      await page.waitForFunction(() => document.body.dataset.scan === "seg.nii");
      await page.select("#labels-format", ".stl");
      await press(page, "#labels .go");
      assert.equal(await ended(page, "labels", 600_000), "");
      const files = unzip(await saved(page, open.downloads, "#labels .saves .main", "regions.zip"));
      const command = (await textOf(page, "#labels .copy:nth-of-type(2) code")).split(" ");
      assert.equal(native(folder, ...command).status, 0);
      assert.ok(files.size > 4);
      // slice, outline, list and 3-D in one colour
      await page.waitForFunction(() => document.body.dataset.shown === "regions", { timeout: 60_000 });
      const png = await (await page.$("#gl")).screenshot({ encoding: "base64" });
      const counts = await page.evaluate(async (data) => {
        const image = Object.assign(new Image(), { src: `data:image/png;base64,${data}` });
        await image.decode();
        const context = Object.assign(document.createElement("canvas"), { width: image.width, height: image.height }).getContext("2d");
        context.drawImage(image, 0, 0);
        const pixels = context.getImageData(0, 0, image.width, image.height).data;
        return [...document.querySelectorAll("#labels .regions .swatch")].map((spot) => {
          const color = spot.style.background.match(/\d+/g).map(Number);
          let count = 0;
          for (let n = 0; n < pixels.length; n += 4) count += [0, 1, 2].every((at) => Math.abs(pixels[n + at] - color[at]) <= 2);
          return count;
        });
      }, png);
      assert.ok(counts.length === 3 && counts.every((count) => count > 1000), String(counts));
      for (const [name, bytes] of files) {
        if (!name.endsWith("report.json")) assert.deepEqual(bytes, readFileSync(join(folder, name)), name);
      }
      await picture(page, `${browserName}-labels`);
    });

    itOnce("makes a mesh of a scan whose name has braces or begins with a dash", async () => {
      await press(page, "#tab-mesh");
      for (const name of ["{{SCRIPT}}.nii", "-o.nii"]) {
        writeNifti(join(folder, name), [40, 44, 48], balls);
        await give(page, "#scan-files", join(folder, name));
        await page.waitForFunction((shown) => (document.body.dataset.scan ?? "").endsWith(shown), {}, name);
        await press(page, "#mesh .go");
        assert.equal(await ended(page, "mesh"), "", name);
      }
    });

    itOnce("joins masks that were chosen together: the program's files", async () => {
      mkdirSync(join(folder, "masks"));
      const mask = (name, at, size = 24) => {
        writeNifti(join(folder, "masks", name), [size, size, size], (i, j, k) => Number(Math.hypot(i - at, j - 12, k - 12) < 6));
        return join(folder, "masks", name);
      };
      await press(page, "#tab-labels");
      const given = [mask("left.nii", 9), mask("right.nii", 15)];
      await give(page, "#labels-file", ...given);
      await page.waitForFunction(() => document.body.dataset.scan === "masks");
      assert.match(await textOf(page, "#facts"), /NIfTI-1, 2 masks/);
      assert.match(await textOf(page, "#scan-warnings"), /in more than one mask/);
      await page.select("#labels-format", ".stl");
      await press(page, "#labels .go");
      assert.equal(await ended(page, "labels"), "");
      const files = unzip(await saved(page, open.downloads, "#labels .saves .main", "regions.zip"));
      const command = (await textOf(page, "#labels .copy:nth-of-type(2) code")).split(" ");
      assert.equal(native(folder, ...command, "--force").status, 0);
      assert.ok(files.has("regions-of-map/regions/left.stl"), String([...files.keys()]));
      for (const [name, bytes] of files) {
        if (!name.endsWith("report.json")) assert.deepEqual(bytes, readFileSync(join(folder, name)), name);
      }
      await give(page, "#labels-file", given[0], mask("small.nii", 9, 20));
      await page.waitForFunction(() => document.querySelector("#labels .refusal").textContent.includes(": left.nii: has 24 x 24 x 24 voxels, small.nii 20 x 20 x 20"));
    });

    itOnce("makes a head model of the example by one click", async () => {
      await press(page, "#tab-head");
      await page.$eval("#head .result", (box) => { box.hidden = true; });  // the last one's stays until the scan is open
      await press(page, "#head-example");
      assert.equal(await ended(page, "head", 600_000), "");
      assert.match(await textOf(page, "#head .verdict"), /^3 surfaces of ([\d,]+), \1, \1 vertices, closed, each inside the next; no triangles cross$/);
      assert.deepEqual(await page.$$eval("#head .notes li", (notes) => notes.map(({ textContent }) => textContent).filter((note) => /cut/.test(note))), []);
      await page.waitForFunction(() => document.body.dataset.shown === "model", { timeout: 60_000 });
      await picture(page, `${browserName}-head-example`);
    });

    itOnce("takes a mask back, and drops it with its scan", async () => {
      await press(page, "#tab-head");
      const mask = () => textOf(page, "#mask-name");
      await give(page, "#mask-file", join(folder, "balls.nii"));
      await page.waitForFunction(() => document.querySelector("#mask-name").textContent.startsWith("balls.nii"));
      await press(page, "#mask-name .remove");
      assert.equal(await mask(), "");
      await give(page, "#mask-file", join(folder, "balls.nii"));
      await give(page, "#head-files", join(folder, "seg.nii"));
      await page.waitForFunction(() => document.querySelector("#head-scan").textContent === "seg.nii", { timeout: 60_000 });
      assert.equal(await mask(), "");
      await press(page, "#tab-labels");
      writeFileSync(join(folder, "names.tsv"), "index\tname\n1\tone\n");
      await give(page, "#names-file", join(folder, "names.tsv"));
      await page.waitForFunction(() => document.querySelector("#names-name").textContent.startsWith("names.tsv"));
      await press(page, "#names-name .remove");
      assert.equal(await textOf(page, "#names-name"), "");
    });

    it("shows where a mesh crosses itself, in the program's words", async () => {
      await press(page, "#tab-check");
      const cube = (x) => [0, 1, 2, 3, 4, 5, 6, 7].map((n) => `v ${x + 10 * (n & 1)} ${5 * (n >> 1 & 1) + x / 2} ${10 * (n >> 2)}`);
      const sides = [[1, 3, 4], [1, 4, 2], [5, 6, 8], [5, 8, 7], [1, 2, 6], [1, 6, 5], [3, 7, 8], [3, 8, 4], [1, 5, 7], [1, 7, 3], [2, 4, 8], [2, 8, 6]];
      writeFileSync(join(folder, "crossing.obj"), [...cube(0), ...cube(4),
        ...[0, 8].flatMap((first) => sides.map((side) => `f ${side.map((n) => n + first).join(" ")}`))].join("\n"));
      await give(page, "#check-files", join(folder, "crossing.obj"));
      await page.waitForFunction(() => document.querySelector("#check-names").textContent.startsWith("crossing.obj"));
      await press(page, "#check .go");
      await page.waitForFunction(() => document.querySelector("#check .verdict") !== null, { timeout: 60_000 });
      const text = await textOf(page, "#check .checks");
      for (const words of ["no self-intersection: ", "vertices manifold", "genus 0", "smallest angle"]) assert.ok(text.includes(words), words);
      assert.match(await textOf(page, "#check .places"), /Show crossing/);
      await press(page, "#check .places button");
      await picture(page, `${browserName}-crossing`);
      await press(page, "#check-names .remove");
      assert.equal(await textOf(page, "#check-names"), "");
    });

    it("checks meshes as the program does", async () => {
      await press(page, "#tab-check");
      await give(page, "#check-files", join(folder, "balls.ply"));
      await page.waitForFunction(() => document.querySelector("#check-names").textContent !== "");
      await press(page, "#check .go");
      await ended(page, "check");
      // angles come from another C library: equal to 12 digits
      const read = (text) => JSON.parse(text, (_, value) => typeof value === "number" ? Number(value.toPrecision(12)) : value).surfaces;
      assert.ok(await page.$eval("#check .saves .main", (button) => button.checkVisibility() && button.closest("details") === null));
      const report = read((await saved(page, open.downloads, "#check .saves .main", "check.json")).toString());
      native(folder, "adaptiso-check", "balls.ply", "--json", "native.json");
      assert.deepEqual(report, read(readFileSync(join(folder, "native.json"))));
    });

    it("keeps a result of meshes where another file is refused", async () => {
      const verdict = await textOf(page, "#check .verdict");
      await give(page, "#check-files", join(folder, "notes.txt"));
      await page.waitForFunction(() => !document.querySelector("#check .refusal").hidden, { timeout: 60_000 });
      assert.match(await textOf(page, "#check .refusal"), /notes\.txt/);
      assert.ok(await page.$eval("#check .verdict", (element) => element.checkVisibility()));
      assert.equal(await textOf(page, "#check .verdict"), verdict);
      assert.doesNotMatch(await textOf(page, "#check-names"), /notes/);
    });

    it("tells meshes of one name apart", async () => {
      await press(page, "#tab-check");
      for (const [name, radius] of [["left", 8], ["right", 16]]) {
        mkdirSync(join(folder, name), { recursive: true });
        writeNifti(join(folder, "ball.nii"), [40, 40, 40], (i, j, k) => Math.max(0, 100 + 5 * (radius - Math.hypot(i - 20, j - 20, k - 20))));
        native(folder, "adaptiso-mesh", "ball.nii", "--iso", "100", "-o", `${name}/ball.ply`);
      }
      await give(page, "#check-files", join(folder, "left/ball.ply"), join(folder, "right/ball.ply"));
      await page.waitForFunction(() => /\d\/ball\.ply \d\/ball\.ply$/.test(document.body.dataset.shown), { timeout: 60_000 });
      await press(page, "#check .go");
      assert.equal(await ended(page, "check"), "");
      const { surfaces } = JSON.parse((await saved(page, open.downloads, "#check .saves .main", "check.json")).toString());
      const [small, large] = surfaces.slice(-2).map((surface) => surface.size.extentMm[0]);
      assert.ok(Math.abs(small - 16) < 0.7 && Math.abs(large - 32) < 0.7, `${small}, ${large}`);
      assert.match(await textOf(page, "#check .result"), /\d\/ball\.ply: .*\d\/ball\.ply: /s);
    });

    it("simplifies and compares meshes as the programs do", async () => {
      await press(page, "#tab-simplify");
      await give(page, "#simplify-files", join(folder, "balls.ply"));
      await page.$eval("#simplify-error", (input) => { input.value = "0.3"; });
      await press(page, "#simplify .go");
      assert.equal(await ended(page, "simplify"), "");
      const bytes = await saved(page, open.downloads, "#simplify .saves .main", "balls-simple.stl");
      assert.equal(native(folder, ...(await textOf(page, "#simplify .copy:nth-of-type(2) code")).split(" ")).status, 0);
      assert.deepEqual(bytes, readFileSync(join(folder, "balls-simple.stl")));

      await press(page, "#tab-compare");
      await give(page, "#compare-files", join(folder, "balls.ply"), join(folder, "balls-simple.stl"));
      await press(page, "#compare .go");
      assert.equal(await ended(page, "compare"), "");
      const colored = await saved(page, open.downloads, "#compare .saves .main", "distance.vtp");
      assert.equal(native(folder, ...(await textOf(page, "#compare .copy:nth-of-type(2) code")).split(" ")).status, 0);
      assert.deepEqual(colored, readFileSync(join(folder, "distance.vtp")));
      assert.match(await textOf(page, "#compare .hint:has(.scale)"), /^[\d.]+ mm inside[\d.]+ mm outside balls-simple\.stl$/);
      await picture(page, `${browserName}-compare`);
    });

    it("mends a mesh as the program does", async () => {
      await press(page, "#tab-mend");
      await give(page, "#mend-files", join(folder, "crossing.obj"));
      await page.$eval("#mend-error", (input) => { input.value = "0.5"; });
      await press(page, "#mend .go");
      assert.equal(await ended(page, "mend"), "");
      assert.match(await textOf(page, "#mend .result"), /A sound solid of .* inner parts? dropped/);
      const bytes = await saved(page, open.downloads, "#mend .saves .main", "crossing-mended.stl");
      assert.equal(native(folder, ...(await textOf(page, "#mend .copy:nth-of-type(2) code")).split(" ")).status, 0);
      assert.deepEqual(bytes, readFileSync(join(folder, "crossing-mended.stl")));
    });

    it("gives axe nothing to find in any tab, wide or narrow, light or dark", async () => {
      await page.evaluate(axe);
      for (const [width, scheme] of [[1280, "light"], [390, "dark"]]) {
        await page.setViewport({ width, height: 844 });
        if (browserName === "chrome") await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: scheme }]);
        for (const tab of ["mesh", "head", "labels", "check", "mend", "simplify", "compare"]) {
          await press(page, `#tab-${tab}`);
          const found = await page.evaluate(async () => (await globalThis.axe.run()).violations
            .map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.target.join(" ")).join(", ")}`));
          assert.deepEqual(found, [], `${tab} at ${width}`);
          const wider = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
          assert.ok(wider <= 0, `${tab} at ${width} is ${wider} px too wide`);
          // whatever the letters: one left edge of all fields, one of all question marks
          for (const column of [".field input:not([type=radio], [type=checkbox]), .field select", ".field .why"]) {
            const edges = await page.$$eval(`#${tab} :is(${column})`, (items) => items.filter((item) => item.checkVisibility())
              .map((item) => Math.round(item.getBoundingClientRect().left)));
            assert.ok(new Set(edges).size <= 1, `${tab} at ${width}: ${column} at ${edges}`);
          }
        }
        await press(page, "#tab-mesh");
        await picture(page, `${browserName}-${width}-${scheme}`);
      }
      await page.setViewport({ width: 1280, height: 900 });
    });

    it("is used by the keyboard alone", { timeout: 200_000 }, async () => {
      const { keyboard } = page, isFocused = (selector) => page.evaluate((text) => document.activeElement.matches(text), selector);
      const tabTo = async (selector) => {
        for (let n = 0; n < 40 && !await isFocused(selector); ++n) await keyboard.press("Tab");
        assert.ok(await isFocused(selector), `Tab does not reach ${selector}`);
      };
      await page.focus("#tab-mesh");
      await keyboard.press("ArrowRight");
      assert.ok(await isFocused("#tab-head"));
      assert.equal(await page.$eval("#head", (element) => element.hidden), false);
      await keyboard.press("Home");
      assert.equal(await page.$eval("#mesh", (element) => element.hidden), false);

      await tabTo("#scan-files");
      await page.evaluate(() => { delete document.body.dataset.scan; });
      const chosen = page.waitForFileChooser();
      await page.evaluate(() => 0);  // input overtakes commands where the page is busy
      const [chooser] = await Promise.all([chosen, keyboard.press(" ")]);
      await chooser.accept([join(folder, "large.nii")]);
      await page.waitForFunction(() => document.body.dataset.scan === "large.nii", { timeout: 60_000 });
      await tabTo("#iso-slider");
      const before = await page.$eval("#iso", (input) => Number(input.value));
      await keyboard.press("ArrowRight");
      assert.ok(await page.$eval("#iso", (input) => Number(input.value)) > before);
      await tabTo("#auto");
      await keyboard.press("Enter");
      assert.equal(await page.$eval("#iso", (input) => Number(input.value)), before);
      await tabTo("#by-distance");
      await keyboard.press("ArrowDown");
      assert.ok(await page.$eval("#by-count", (input) => input.checked));
      await tabTo("#triangles");
      await keyboard.type("4000");
      await keyboard.press("Tab");
      assert.ok(await isFocused("details.why summary"));
      await keyboard.press("Enter");
      await page.waitForSelector("details.why[open]");
      await keyboard.press("Escape");
      assert.equal(await page.$("details.why[open]"), null);
      await tabTo("#largest");
      await keyboard.press(" ");
      await tabTo("#format");
      await keyboard.type("PLY");
      await tabTo("#mesh .go");
      await keyboard.press("Enter");
      await page.waitForFunction(() => document.body.dataset.running === "mesh", { timeout: 60_000 });
      assert.ok(await isFocused("#mesh .cancel"), "a run's Cancel has the focus of the button that started it");
      await keyboard.press("Enter");
      assert.equal(await ended(page, "mesh"), "Cancelled.");
      assert.ok(await isFocused("#mesh .go"));

      await page.focus("#tab-mesh");
      await tabTo("#example");
      await keyboard.press("Enter");
      await page.waitForFunction(() => document.body.dataset.scan === "example.nii" && document.body.dataset.running === "mesh", { timeout: 60_000 });
      assert.equal(await ended(page, "mesh"), "");
      await tabTo("#mesh .saves .main");
      await keyboard.press("Enter");
      assert.match((await arrived(open.downloads, "example.ply")).toString("latin1", 0, 3), /ply/);
      await tabTo("#mesh .copy button");
      await keyboard.press("Enter");
      await page.waitForFunction(() => /Copied|Select/.test(document.querySelector("#mesh .copy button").textContent));
      await tabTo("#gl");
      const place = await textOf(page, "#position");
      await keyboard.press("ArrowUp");
      await page.waitForFunction((text) => document.querySelector("#position").textContent !== text, {}, place);
    });
  });
}
