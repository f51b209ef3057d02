// Examples/vite with the npm package, as its README says: built, and served while it is written.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { cpSync, existsSync, readdirSync, rmSync } from "node:fs";
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
    call("npm", "install", "--ignore-scripts", "--no-audit", "--no-fund", "--silent", resolve(kPackages, kArchive));
    call("npx", "vite", "build", "--logLevel", "error");
    writeNifti(join(folder, "balls.nii"), [48, 48, 48], balls);
    browser = await puppeteer.launch({ executablePath: "/usr/bin/chromium", headless: true, args: ["--no-sandbox"], timeout: 120_000 });
  });
  after(async () => {
    await browser?.close();
    rmSync(folder, { recursive: true, force: true });
  });

  for (const [name, args] of [["built", ["preview"]], ["served", []]]) {
    it(`makes a surface of a file, ${name}`, async () => {
      const server = spawn("node_modules/.bin/vite", args, { cwd: folder, env: { ...process.env, NO_COLOR: "1" } });
      try {
        const address = await new Promise((done, fail) => {
          server.stdout.on("data", (text) => { if (/Local: +\S/.test(text)) done(/Local: +(\S+)/.exec(text)[1]); });
          server.on("exit", (code) => fail(new Error(`vite ended with ${code}`)));
        });
        const page = await browser.newPage();
        await page.goto(address, { waitUntil: "networkidle0" });
        const ended = () => page.waitForFunction(() => document.getElementById("state").textContent !== "" && document.getElementById("cancel").disabled,
          { timeout: 60_000 });
        await (await page.$("#image")).uploadFile(join(folder, "balls.nii"));
        await ended();
        assert.match(await page.$eval("#state", (element) => element.textContent), /^\d{3,} triangles$/);
        await page.$eval("#state", (element) => { element.textContent = ""; });
        await (await page.$("#image")).uploadFile(join(folder, "package.json"));
        await ended();
        assert.match(await page.$eval("#state", (element) => element.textContent), /^adaptiso-mesh: package\.json: /);
      } finally {
        server.kill();
      }
    });
  }
});
