// Shared by the tests: browsers, inputs made here, and the native programs.
import { spawnSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import puppeteer from "puppeteer-core";

export const kTop = resolve(import.meta.dirname ?? ".", "../../../..");
export const kPage = process.env.ADAPTISO_PAGE ?? join(kTop, "build/web/adaptiso.html");
const kPrograms = process.env.ADAPTISO_BIN ?? join(kTop, "build/release/bin");
export const kPictures = process.env.ADAPTISO_PICTURES ?? join(kTop, "build/web/pictures");
export const kBrowsers = (process.env.ADAPTISO_BROWSERS ?? "chrome,firefox").split(",");
const kExecutables = { chrome: "/usr/bin/chromium", firefox: "/usr/bin/firefox-esr" };

/** A page of the file as people open it, what it asks the network for, and where it saves. */
export async function openPage(browserName, { width = 1280, height = 900, isDark = false } = {}) {
  const downloads = mkdtempSync(join(tmpdir(), "adaptiso-page-"));
  const browser = await puppeteer.launch({ browser: browserName, executablePath: kExecutables[browserName], headless: true,
    protocolTimeout: 600_000, timeout: 120_000,
    args: browserName === "chrome" ? ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] : [],
    extraPrefsFirefox: { "browser.download.folderList": 2, "browser.download.dir": downloads,
      "browser.download.useDownloadDir": true, "browser.helperApps.neverAsk.saveToDisk": "application/octet-stream",
      "browser.download.alwaysOpenPanel": false,  // the panel takes the focus
      "webgl.force-enabled": true },
    ...(browserName === "chrome" ? { downloadBehavior: { policy: "allow", downloadPath: downloads } } : {}) });
  const page = await browser.newPage();
  await page.setViewport({ width, height });
  if (isDark) await page.emulateMediaFeatures([{ name: "prefers-color-scheme", value: "dark" }]);
  const requests = [], errors = [];
  page.on("request", (request) => {
    if (!/^(file|data|blob|about):/.test(request.url())) requests.push(request.url());
  });
  page.on("pageerror", (error) => errors.push(String(error)));
  await page.goto(pathToFileURL(kPage).href);
  await page.waitForSelector("body[data-ready=true]");
  return { browser, page, downloads, requests, errors };
}

export async function give(page, selector, ...files) {
  await page.evaluate(() => { delete document.body.dataset.scan; });
  const input = await page.$(selector);
  await input.uploadFile(...files);
}

/** Waits for the run of a tab to end. \return its refusal; empty where there is none */
export async function ended(page, tab, timeout = 100_000) {
  await page.waitForFunction((id) => document.querySelector(`#${id} .go`).disabled === false
    && (document.querySelector(`#${id} .result`).hidden === false || document.querySelector(`#${id} .refusal`).hidden === false),
    { timeout, polling: 50 }, tab);
  return page.$eval(`#${tab} .refusal`, (element) => (element.hidden ? "" : element.textContent));
}

export const press = (page, selector) => page.$eval(selector, (element) => element.click());
export const choicesOf = (page, select) => page.$$eval(`${select} option`, (options) => options.map(({ value }) => value));
export const textOf = (page, selector) => page.$eval(selector, (element) => element.textContent);

/** The file that a button saves. */
export async function saved(page, downloads, selector, name) {
  rmSync(join(downloads, name), { force: true });
  await press(page, selector);
  return arrived(downloads, name);
}

/** Waits for a download. */
export async function arrived(downloads, name) {
  const path = join(downloads, name);
  for (let n = 0; n < 300; ++n) {
    if (existsSync(path) && !existsSync(`${path}.part`) && !existsSync(`${path}.crdownload`)) {
      const bytes = readFileSync(path);
      if (bytes.length > 0) return bytes;
    }
    await new Promise((done) => setTimeout(done, 100));
  }
  throw new Error(`${name} was not saved`);
}

/** Runs a native program in `folder`. */
export function native(folder, program, ...args) {
  const { status, stdout, stderr, error } = spawnSync(join(kPrograms, program), args, { cwd: folder, encoding: "utf8" });
  if (error) throw error;
  return { status, stdout, line: stderr.trim().split("\n").at(-1) };
}

export function makeFolder() { return mkdtempSync(join(tmpdir(), "adaptiso-test-")); }

export async function picture(page, name) {
  mkdirSync(kPictures, { recursive: true });
  await page.screenshot({ path: join(kPictures, `${name}.png`) });
}

/** A NIfTI of unsigned bytes. \param changes  [offset, type, value] of its header */
export function writeNifti(path, size, sample, changes = [], bytesEach = 1) {
  const count = size.reduce((a, b) => a * b, 1), bytes = Buffer.alloc(352 + count * bytesEach);
  bytes.writeInt32LE(348, 0);
  bytes.writeInt16LE(size.length, 40);
  for (let axis = 0; axis < 7; ++axis) bytes.writeInt16LE(size[axis] ?? 1, 42 + 2 * axis);
  for (let axis = 0; axis < 4; ++axis) bytes.writeFloatLE(1, 76 + 4 * axis);
  bytes.writeInt16LE(2, 70);
  bytes.writeInt16LE(8, 72);
  bytes.writeFloatLE(352, 108);
  bytes[123] = 2;
  bytes.writeInt16LE(1, 254);
  [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0].forEach((value, n) => { bytes.writeFloatLE(value, 280 + 4 * n); });
  bytes.write("n+1", 344, "latin1");
  for (let n = 0; n < count; ++n) {
    const [nx, ny, nz = 1] = size, slice = Math.floor(n / nx / ny);
    bytes[352 + n * bytesEach] = sample(n % nx, Math.floor(n / nx) % ny, slice % nz, Math.floor(slice / nz));
  }
  for (const [offset, type, value] of changes) bytes[`write${type}`](value, offset);
  writeFileSync(path, bytes);
}

/** Two overlapping balls with a cavity, bumpy. */
export function balls(i, j, k) {
  const d = (x, y, z) => Math.hypot(i - x, j - y, k - z);
  const bumps = 2 * Math.sin(i / 2.3) * Math.cos(j / 1.9) * Math.sin(k / 2.7);
  const inside = Math.max(15 - d(20, 22, 24), 10 - d(33, 25, 24)) + bumps, cavity = 5 - d(19, 22, 24);
  return Math.max(0, Math.min(255, Math.round(120 + 14 * Math.min(inside, -cavity))));
}

/** Brain, skull and scalp as labels 1, 2, 3: balls of 62, 70 and 78 mm at 2 mm. */
export function headLabels(i, j, k) {
  const d = 2 * Math.hypot(i - 42, j - 42, k - 42);
  return d < 62 ? 1 : d < 70 ? 2 : d < 78 ? 3 : 0;
}

/** A slice of a DICOM series of `size` slices of size x size voxels of 1 mm, Explicit VR Little Endian. */
export function dicomSlice(series, n, size) {
  const element = (group, number, type, value) => {
    const short = (v) => { const b = Buffer.alloc(2); b.writeUInt16LE(v); return b; };
    const data = typeof value === "number" ? short(value) : typeof value === "string"
      ? Buffer.from(value.length % 2 ? `${value}${type === "UI" ? "\0" : " "}` : value) : value;
    const head = Buffer.alloc(["OB", "OW"].includes(type) ? 12 : 8);
    head.writeUInt16LE(group, 0);
    head.writeUInt16LE(number, 2);
    head.write(type, 4);
    if (head.length === 12) head.writeUInt32LE(data.length, 8); else head.writeUInt16LE(data.length, 6);
    return Buffer.concat([head, data]);
  };
  const kMr = "1.2.840.10008.5.1.4.1.1.4", uid = `1.2.3.${series}.${n + 1}`, pixels = Buffer.alloc(2 * size * size);
  for (let at = 0; at < size * size; ++at) pixels.writeUInt16LE(100 * (at % size), 2 * at);
  const meta = Buffer.concat([element(2, 1, "OB", Buffer.from([0, 1])), element(2, 2, "UI", kMr), element(2, 3, "UI", uid),
    element(2, 0x10, "UI", "1.2.840.10008.1.2.1"), element(2, 0x12, "UI", "1.2.3")]);
  const length = Buffer.alloc(4);
  length.writeUInt32LE(meta.length);
  return Buffer.concat([Buffer.alloc(128), Buffer.from("DICM"), element(2, 0, "UL", length), meta,
    element(8, 0x16, "UI", kMr), element(8, 0x18, "UI", uid), element(8, 0x60, "CS", "MR"),
    element(8, 0x103e, "LO", `series ${series}`),
    element(0x18, 0x50, "DS", "1"), element(0x20, 0xd, "UI", "1.2.3"), element(0x20, 0xe, "UI", `1.2.3.${series}`),
    element(0x20, 0x11, "IS", String(series)), element(0x20, 0x13, "IS", String(n + 1)),
    element(0x20, 0x32, "DS", `0\\0\\${n}`), element(0x20, 0x37, "DS", "1\\0\\0\\0\\1\\0"), element(0x20, 0x52, "UI", "1.2.3.9"),
    element(0x28, 2, "US", 1), element(0x28, 4, "CS", "MONOCHROME2"), element(0x28, 0x10, "US", size), element(0x28, 0x11, "US", size),
    element(0x28, 0x30, "DS", "1\\1"), element(0x28, 0x100, "US", 16), element(0x28, 0x101, "US", 16), element(0x28, 0x102, "US", 15),
    element(0x28, 0x103, "US", 0), element(0x7fe0, 0x10, "OW", pixels)]);
}
