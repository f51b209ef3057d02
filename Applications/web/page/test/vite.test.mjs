// Examples/vite with the npm package, as its README says: built, and served while it is written; NiiVue; and no bundler.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { cpSync, existsSync, readFileSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { createServer } from "node:http";
import { dirname, join, resolve } from "node:path";
import { after, before, describe, it } from "node:test";
import puppeteer from "puppeteer-core";
import { balls, kBrowsers, kPage, kTop, makeFolder, writeNifti } from "./support.mjs";

const kPackages = join(dirname(kPage), "npm");
const kArchive = existsSync(kPackages) && readdirSync(kPackages).filter((name) => name.endsWith(".tgz")).sort().at(-1);

describe("the example with Vite", { skip: !kBrowsers.includes("chrome") }, () => {
  let folder, browser;
  const call = (...command) => {
    const done = spawnSync(command[0], command.slice(1), { cwd: folder, encoding: "utf8", timeout: 120_000 });
    assert.equal(done.status, 0, done.stdout + done.stderr);
  };
  before(async () => {
    folder = makeFolder();
    cpSync(join(kTop, "Examples/vite"), folder, { recursive: true });
    call("npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--silent", resolve(kPackages, kArchive), "@niivue/niivue@0.69.0");
    call("npx", "vite", "build", "--logLevel", "error");
    writeNifti(join(folder, "balls.nii"), [48, 48, 48], balls, [[280, "FloatLE", 1.5], [292, "FloatLE", -30], [308, "FloatLE", 12]]);
    browser = await puppeteer.launch({ executablePath: "/usr/bin/chromium", headless: true,
      args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"], timeout: 120_000 });
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
  });

  /** Calls `use` with a page of a server of Vite. */
  async function served(args, path, use) {
    const server = spawn("node_modules/.bin/vite", args, { cwd: folder, env: { ...process.env, NO_COLOR: "1" } });
    try {
      const address = await new Promise((done, fail) => {
        server.stdout.on("data", (text) => { if (/Local: +\S/.test(text)) done(/Local: +(\S+)/.exec(text)[1]); });
        server.on("exit", (code) => fail(new Error(`vite ended with ${code}`)));
      });
      const page = await browser.newPage();
      await page.goto(address + path, { waitUntil: "networkidle0" });
      await use(page);
    } finally {
      server.kill();
    }
  }

  for (const [name, args] of [["built", ["preview"]], ["served", []]]) {
    it(`makes a surface of a file, ${name}`, async () => {
      await served(args, "", async (page) => {
        const state = async (file) => {
          await page.$eval("#state", (element) => { element.textContent = ""; });
          await (await page.$("#image")).uploadFile(join(folder, file));
          await page.waitForFunction(() => document.getElementById("state").textContent !== "" && document.getElementById("cancel").disabled,
            { timeout: 60_000 });
          return page.$eval("#state", (element) => element.textContent);
        };
        assert.match(await state("balls.nii"), /^\d{3,} triangles$/);
        assert.match(await state("package.json"), /^adaptiso-mesh: package\.json: /);
      });
    });
  }

  it("adds to NiiVue the surface of the volume it shows, where the file's own lies", async () => {
    writeFileSync(join(folder, "niivue.html"), '<canvas id="gl" width="400" height="400"></canvas><script type="module" src="./niivue.js"></script>');
    writeFileSync(join(folder, "niivue.js"), `
      import { Niivue } from "@niivue/niivue";
      import { mesh } from "adaptiso";
      import { addSurface } from "adaptiso/niivue";
      const niivue = new Niivue(), refusal = await addSurface(niivue).catch((error) => error.message);
      await niivue.attachToCanvas(document.getElementById("gl"));
      await niivue.loadVolumes([{ url: "./balls.nii" }]);
      const { added } = await addSurface(niivue, { iso: 120 });
      const bytes = new Uint8Array(await (await fetch("./balls.nii")).arrayBuffer());
      const { mesh: own } = await mesh({ path: "balls.nii", bytes }, { iso: 120 });
      window.found = { refusal, meshes: niivue.meshes.length, points: [...added.pts], triangles: [...added.tris],
        own: { points: [...own.points], triangles: [...own.triangles] } };`);
    await served([], "niivue.html", async (page) => {
      await page.waitForFunction(() => window.found !== undefined, { timeout: 60_000 });
      const { refusal, meshes, points, triangles, own } = await page.evaluate(() => window.found);
      assert.match(refusal, /^addSurface: niivue shows no volume/);
      assert.equal(meshes, 1);
      assert.deepEqual(triangles, own.triangles);
      assert.equal(points.length, own.points.length);
      assert.ok(points.every((x, n) => Math.abs(x - own.points[n]) < 1e-5));  // NiiVue's are floats
    });
  });

  it("makes a surface without a bundler", async () => {
    writeFileSync(join(folder, "plain.html"), `<script type="module">
      import { mesh } from "./node_modules/adaptiso/index.mjs";
      const bytes = new Uint8Array(await (await fetch("./balls.nii")).arrayBuffer());
      window.found = (await mesh({ path: "balls.nii", bytes }, { iso: 120 })).mesh.triangles.length / 3;</script>`);
    const server = createServer((request, response) => {
      const file = join(folder, request.url), kind = { html: "text/html", wasm: "application/wasm" }[file.split(".").at(-1)];
      response.writeHead(existsSync(file) ? 200 : 404, { "content-type": kind ?? "text/javascript" }).end(existsSync(file) ? readFileSync(file) : "");
    });
    await new Promise((done) => { server.listen(0, "127.0.0.1", done); });
    const page = await browser.newPage();
    await page.goto(`http://127.0.0.1:${server.address().port}/plain.html`);
    await page.waitForFunction(() => window.found > 100, { timeout: 60_000 });
    server.close();
  });
});
