// The functions of the npm package under Node, on arrays and files; ADAPTISO_WEB or build/web holds what is tried.
import assert from "node:assert/strict";
import { File } from "node:buffer";
import { cpSync, mkdtempSync, renameSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join } from "node:path";
import { describe, it } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";

const kTop = join(dirname(fileURLToPath(import.meta.url)), "../../../..");
const kPackage = join(process.env.ADAPTISO_WEB ?? join(kTop, "build/web"), "npm/adaptiso");
const { AdaptisoError, bem, check, compare, labels, mend, mesh, run, simplify } = await import(pathToFileURL(join(kPackage, "index.mjs")));

/** An image of `n` voxels of `step` mm along each axis about (0, 0, 0). */
function image(n, step, sampleAt, Type = Int16Array) {
  const first = -step * (n - 1) / 2, data = new Type(n ** 3);
  for (let at = 0; at < data.length; ++at) {
    data[at] = sampleAt(...[at % n, Math.floor(at / n) % n, Math.floor(at / n ** 2)].map((index) => first + step * index));
  }
  return { data, size: [n, n, n], affine: [step, 0, 0, first, 0, step, 0, first, 0, 0, step, first] };
}
/** 100 at `radius` mm, 10 a mm. */
const ball = (radius, Type = Int16Array) => image(40, 1, (x, y, z) => Math.round(100 + 10 * (radius - Math.hypot(x, y, z))), Type);
const ballMesh = async (radius) => (await mesh(ball(radius), { iso: 100 })).mesh;

/** By the divergence theorem; positive where triangles are counter-clockwise seen from outside. */
function volume({ points, triangles }) {
  let six = 0;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((n) => points.subarray(3 * triangles[t + n], 3 * triangles[t + n] + 3));
    six += a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  }
  return six / 6;
}
const ballVolume = (radius) => 4 / 3 * Math.PI * radius ** 3;
const near = (value, expected, share) => assert.ok(Math.abs(value - expected) <= share * expected, `${value} is not ${expected}`);

/** The surface as the file of a name. */
async function stl(radius, path) {
  const { files } = await run("mesh", ["ball.nii", "--iso", "100", "-o", "out.stl"], [{ path: "ball.nii", bytes: nifti1(ball(radius)) }]);
  return { path, bytes: files[0].bytes };
}
/** A NIfTI-1 file, written apart from the package. */
function nifti1({ data, size, affine }) {
  const head = Buffer.alloc(352);
  head.writeInt32LE(348, 0);
  [3, ...size, 1, 1, 1, 1].forEach((n, at) => head.writeInt16LE(n, 40 + 2 * at));
  head.writeInt16LE(4, 70);
  head.writeInt16LE(16, 72);
  [1, affine[0], affine[5], affine[10]].forEach((step, at) => head.writeFloatLE(step, 76 + 4 * at));
  head.writeFloatLE(352, 108);
  head.writeUInt8(2, 123);
  head.writeInt16LE(1, 254);
  affine.forEach((x, at) => head.writeFloatLE(x, 280 + 4 * at));
  head.write("n+1\0", 344, "latin1");
  return new Uint8Array(Buffer.concat([head, Buffer.from(data.buffer)]));
}
const refused = (promise, exitCode, line) => assert.rejects(promise, (error) => {
  assert.ok(error instanceof AdaptisoError, String(error));
  assert.match(error.message, line);
  assert.doesNotMatch(error.message, /\n/);
  assert.equal(error.exitCode, exitCode);
  return true;
});

describe("mesh", () => {
  it("makes the ball's surface of arrays of every type", async () => {
    for (const Type of [Uint8Array, Int16Array, Uint16Array, Int32Array, Uint32Array, Float32Array, Float64Array]) {
      const samples = image(24, 1, (x, y, z) => Math.max(0, Math.round(100 + 10 * (8 - Math.hypot(x, y, z)))), Type);
      const done = await mesh(samples, { iso: 100, maxErrorMm: 0.2 });
      near(volume(done.mesh), ballVolume(8), 0.03);
      assert.equal(done.exitCode, 0);
      assert.equal(done.report.mesh?.triangles ?? done.mesh.triangles.length / 3, done.mesh.triangles.length / 3);
    }
  });
  it("puts it where the affine says, of 12 numbers or 16, in an array or typed", async () => {
    const given = ball(12), moved = [...given.affine];
    moved[3] += 100;
    const affines = [moved, [...moved, 0, 0, 0, 1], Float64Array.from(moved)];
    const all = await Promise.all(affines.map((affine) => mesh({ ...given, affine }, { iso: 100 })));
    const x = all[0].mesh.points.filter((_, n) => n % 3 === 0);
    near((Math.max(...x) + Math.min(...x)) / 2, 100, 0.001);
    for (const { mesh: other } of all) assert.deepEqual(other, all[0].mesh);
  });
  it("gives arrays and files the same surface, and options.args to the program", async () => {
    const options = { iso: 100, triangles: 500, smoothMm: 0.7, args: ["--largest"] };
    const [arrays, file] = await Promise.all([mesh(ball(12), options), mesh({ path: "./in/ball.nii", bytes: nifti1(ball(12)) }, options)]);
    assert.deepEqual(file.mesh, arrays.mesh);
    assert.ok(file.mesh.triangles.length / 3 <= 500);
    const without = await mesh(ball(12), { iso: 100, triangles: 500 });
    assert.notDeepEqual(without.mesh.points, arrays.mesh.points);
  });
  it("gives the report's warnings, a line each", async () => {
    const bytes = nifti1(ball(12)), longer = new Uint8Array(bytes.length + 3);
    longer.set(bytes);
    const { report, warnings } = await mesh({ path: "ball.nii", bytes: longer }, { iso: 100, args: ["--no-warnings"] });
    assert.deepEqual(report.warnings.map(({ code }) => code), ["trailing-bytes"]);
    assert.deepEqual(warnings, [`ball.nii: ${report.warnings[0].text}`]);
  });
  it("reads a File", async () => {
    near(volume((await mesh(new File([nifti1(ball(12))], "ball.nii"), { iso: 100 })).mesh), ballVolume(12), 0.03);
  });
  it("refuses a Blob, which has no name", async () => {
    await assert.rejects(mesh(new Blob([nifti1(ball(12))]), { iso: 100 }), { message: /without a name/, exitCode: 2 });
  });
  it("reads names that look like options", async () => {
    near(volume((await mesh({ path: "--iso.nii", bytes: nifti1(ball(12)) }, { iso: 100 })).mesh), ballVolume(12), 0.03);
  });
  it("reports progress", async () => {
    const seen = [];
    await mesh(ball(12), { iso: 100, onProgress: (text) => seen.push(text) });
    assert.ok(seen.some((text) => / (\d+ %|\.\.\.)$/.test(text)), seen.join());
  });
  it("throws what onProgress throws", async () => {
    const mine = new Error("mine");
    await assert.rejects(mesh(ball(12), { iso: 100, onProgress() { throw mine; } }), mine);
    await assert.rejects(mesh(ball(12), { iso: 100, onProgress: "text" }), TypeError);
  });
  it("refuses wrong arrays in one line", async () => {
    const given = ball(12);
    for (const [change, line] of [
      [{ data: [1, 2] }, /^image\.data is no typed array/], [{ data: new Int16Array(5) }, /^image\.data has 5 samples, .* 40 x 40 x 40$/],
      [{ size: [40, 40] }, /^image\.size must be three whole numbers/], [{ size: undefined }, /^image\.size /],
      [{ size: [40, 40, 40.5] }, /^image\.size /], [{ size: [-40, -40, 40] }, /^image\.size /],
      [{ affine: undefined }, /^image\.affine must be 12 or 16 finite numbers/], [{ affine: [1, 2, 3] }, /^image\.affine must/],
      [{ affine: given.affine.with?.(3, NaN) ?? Array(12).fill(NaN) }, /^image\.affine must/],
      [{ affine: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]] }, /^image\.affine must/],
      [{ affine: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, -20, -20, -20, 1] }, /^image\.affine's fourth row/],
    ]) await refused(mesh({ ...given, ...change }, { iso: 100 }), 3, line);
    await refused(mesh(undefined), 2, /^an input must be arrays/);
  });
  it("throws the program's own line and code", async () => {
    await refused(mesh({ path: "text.nii", bytes: new TextEncoder().encode("no image") }), 3, /^adaptiso-mesh: text\.nii: /);
    await refused(mesh(ball(12), { iso: 100, args: ["--nothing"] }), 2, /^adaptiso-mesh: .*--nothing/);
    await refused(mesh(ball(12), { iso: 100, nothing: 1 }), 2, /^adaptiso-mesh: .*--nothing/);
    await refused(mesh(ball(12), { iso: 100, args: ["--help"] }), 2, /^adaptiso-mesh: wrote no result/);
  });
});

describe("simplify", () => {
  it("makes fewer triangles of arrays, and of its own output's file", async () => {
    const full = await mesh(ball(12), { iso: 100, maxErrorMm: 0.05 });
    const few = await simplify(full.mesh, { triangles: 200 });
    assert.ok(few.mesh.triangles.length / 3 <= 200);
    near(volume(few.mesh), ballVolume(12), 0.1);
    const again = await simplify(full.files.find(({ path }) => path.endsWith(".ply")), { triangles: 200 });
    assert.deepEqual(again.mesh, few.mesh);
    assert.deepEqual(again.files.map(({ path }) => path), few.files.map(({ path }) => path));
  });
  it("refuses arrays that are no mesh", async () => {
    await refused(simplify({ points: new Float64Array(4), triangles: new Uint32Array(3) }, { triangles: 9 }), 3, /^mesh\.points and/);
    await refused(simplify({ points: [], triangles: new Uint32Array(3) }, { triangles: 9 }), 3, /^mesh\.points and/);
    const points = new Float64Array(12);
    for (const wrong of [{ points, triangles: new Float64Array([0, 2.7, 1]) }, { points, triangles: new BigUint64Array(3) },
      { points: new BigInt64Array(12), triangles: new Uint32Array(3) }]) await refused(check(wrong), 3, /^mesh\.points and/);
  });
});

describe("mend", () => {
  it("closes a hole, and leaves it open where asked", async () => {
    const closed = await ballMesh(12), open = { ...closed, triangles: closed.triangles.slice(3) };
    const mended = await mend(open, { maxErrorMm: 0.3, maxHoleMm: 5 });
    assert.equal(mended.report.output.closed, true);
    near(volume(mended.mesh), volume(closed), 0.1);
    await refused(mend(open, { maxErrorMm: 0.01, maxHoleMm: 0.1 }), 1, /^adaptiso-mend: .*--max-hole/);
    assert.equal((await mend(open, { maxErrorMm: 0.01, maxHoleMm: 0.1, open: true })).report.output.closed, false);
  });
});

describe("check", () => {
  it("passes a closed surface and names the faults of an open one", async () => {
    const closed = await ballMesh(12), open = { ...closed, triangles: closed.triangles.slice(3) };
    const good = await check(closed), bad = await check([closed, open]);
    assert.deepEqual([good.exitCode, bad.exitCode], [0, 1]);
    assert.deepEqual(bad.report.surfaces.map((surface) => surface.passed), [true, false]);
  });
  it("tells files of one name apart", async () => {
    const [small, large] = [await stl(8, "lh.stl"), await stl(16, "lh.stl")];
    const { report, files } = await check([small, large, small]);
    const [first, second, third] = report.surfaces.map((surface) => surface.size.extentMm[0]);
    near(first, 16, 0.02);
    near(second, 32, 0.02);
    assert.equal(third, first);
    assert.deepEqual(files, []);
  });
});

describe("compare", () => {
  it("measures two balls, of arrays and of files of one name", async () => {
    const arrays = await compare(await ballMesh(12), await ballMesh(14));
    near(arrays.report.distances.combined.meanMm, 2, 0.05);
    for (const names of [["lh.stl", "lh.stl"], ["lh.stl", "./lh.stl"], ["a/lh.stl", "a//lh.stl"], ["lh.stl", "lh.stl/lh.stl"]]) {
      const done = await compare(await stl(12, names[0]), await stl(14, names[1]));
      near(done.report.distances.combined.meanMm, 2, 0.05);
      assert.deepEqual(done.files, []);
    }
  });
  it("keeps different names as they are", async () => {
    const { report } = await compare(await stl(12, "a.stl"), await stl(14, "b.stl"));
    assert.match(JSON.stringify(report), /"a\.stl"/);
    assert.match(JSON.stringify(report), /"b\.stl"/);
  });
});

describe("labels", () => {
  const regions = image(32, 1, (x, y, z) => (Math.hypot(x, y, z) > 12 ? 0 : x < 0 ? 1 : 2), Uint8Array);
  it("writes a surface of each region", async () => {
    const { report, files } = await labels(regions, { format: "ply" });
    assert.equal(files.filter(({ path }) => path.startsWith("regions/") && path.endsWith(".ply")).length, 2, files.map(({ path }) => path).join());
    assert.equal(typeof report, "object");
  });
  it("keeps an input apart from its output's folder", async () => {
    const bytes = nifti1({ ...regions, data: Int16Array.from(regions.data) });
    const { files } = await labels({ path: "regions/seg.nii", bytes });
    assert.ok(files.length >= 2 && files.every(({ path }) => path.startsWith("regions/") && !path.endsWith(".nii")));
  });
});

describe("bem", () => {
  it("makes a head model of a T1 and a mask, of arrays or of files of one name", async () => {
    const layers = (x, y, z) => {
      const r = Math.hypot(x, y, z);
      return r < 62 ? 100 : r < 64 ? 30 : r < 70 ? 15 : r < 78 ? 150 : 2;
    };
    const t1 = image(85, 2, (x, y, z) => layers(x, y, z) + (Math.abs(7 * x + 13 * y + 29 * z) % 5));
    const mask = image(85, 2, (x, y, z) => (Math.hypot(x, y, z) < 62 ? 1 : 0));
    const [arrays, files] = await Promise.all([bem(t1, { mask, vertices: 642 }),
      bem({ path: "scan.nii", bytes: nifti1(t1) }, { mask: { path: "scan.nii", bytes: nifti1(mask) }, vertices: 642 })]);
    for (const done of [arrays, files]) {
      assert.ok(done.files.some(({ path }) => path.startsWith("model/")));
      assert.ok(done.files.every(({ path }) => path.startsWith("model/")), done.files.map(({ path }) => path).join());
    }
    const surfaces = (done) => done.files.filter(({ path }) => /\.(surf|tri)$/.test(path)).map(({ path, bytes }) => [path, bytes]);
    assert.ok(surfaces(arrays).length >= 3);
    assert.deepEqual(surfaces(files), surfaces(arrays));
  });
});

describe("run", () => {
  const file = { path: "ball.nii", bytes: nifti1(ball(12)) };
  it("runs a program on files, and returns what it wrote alone", async () => {
    const { exitCode, files } = await run("mesh", ["in/ball.nii", "--iso", "100", "-o", "out/ball.stl"], [{ ...file, path: "./in/./ball.nii" }],
      { folders: ["out"] });
    assert.equal(exitCode, 0);
    assert.deepEqual(files.map(({ path }) => path), ["out/ball.stl"]);
  });
  it("refuses paths that are equal or lead out of its folder", async () => {
    await refused(run("check", [], [file, { ...file, path: "./ball.nii" }]), 2, /^two files have the path "ball\.nii"/);
    for (const path of ["../ball.nii", "a/../../ball.nii", "/ball.nii", "", ".", undefined]) {
      await refused(run("check", [], [{ ...file, path }]), 2, /must be relative/);
    }
    await refused(run("check", [], [file], { folders: ["../out"] }), 2, /must be relative/);
    await refused(run("check", [], [{ ...file, bytes: "text" }]), 2, /bytes must be a Uint8Array/);
  });
  it("refuses paths that no folder could hold, and what is no list, in a line without control characters", async () => {
    const bytes = new Uint8Array(4), one = { path: "a", bytes };
    for (const [files, folders, line] of [
      [[one, { path: "a/b", bytes }], [], /^the path "a" is a file and a folder/],
      [[one], ["a/b"], /^the path "a" is a file/], [[one], ["a"], /^the path "a" is a file/],
      [[{ path: "d/".repeat(3000) + "x", bytes }], [], /^the path "(d\/)+\.\.\." is too long/],
      [[{ path: "/\x1b[31m\u009b\u202e", bytes }], [], /^the path "\/ \[31m  " must be relative/],
      [[{ path: "\x1b[31m", bytes: "text" }], [], /^ \[31m: bytes must be/],
      [null, [], /^files must be an array/], [[null], [], /^a file must be/]]) {
      await refused(run("check", ["a"], files, { folders }), 2, line);
    }
    for (const args of [null, "--help", [null], [5]]) await refused(run("check", args, []), 2, /^args must be an array of strings/);
    await refused(check({ path: "a.off", bytes }, { args: {} }), 2, /^args must be an array of strings/);
  });
  it("runs two at once with the bytes of one", async () => {
    const one = () => run("mesh", ["ball.nii", "--iso", "100", "-o", "out.ply"], [file]);
    const [first, second] = await Promise.all([one(), one()]);
    assert.deepEqual(first.files, second.files);
    assert.deepEqual((await one()).files, first.files);
  });
  it("ends by an abort with its reason, before and meanwhile, and others go on", async () => {
    const reason = new Error("enough"), controller = new AbortController();
    await assert.rejects(mesh(ball(12), { signal: AbortSignal.abort(reason) }), reason);
    const other = mesh(ball(12), { iso: 100 });
    const large = image(128, 1, (x, y, z) => 100 * Math.sin(x / 2) * Math.sin(y / 2) * Math.sin(z / 2));
    await assert.rejects(mesh(large, { iso: 0, signal: controller.signal, onProgress: () => controller.abort(reason) }), reason);
    near(volume((await other).mesh), ballVolume(12), 0.03);
  });
});

describe("the WebAssembly file", () => {
  /** A copy of the package, whose file can be changed. */
  async function copied(change) {
    const folder = mkdtempSync(join(tmpdir(), "adaptiso-npm-"));
    cpSync(kPackage, folder, { recursive: true });
    const wasm = join(folder, "adaptiso.wasm");
    change(wasm);
    return { folder, wasm, package: await import(pathToFileURL(join(folder, "index.mjs"))) };
  }
  it("is read again after a failure", async () => {
    const copy = await copied((wasm) => renameSync(wasm, `${wasm}.away`));
    await assert.rejects(copy.package.mesh(ball(12), { iso: 100 }), { name: "AdaptisoError", exitCode: 4, message: /^adaptiso\.wasm cannot be loaded: / });
    renameSync(`${copy.wasm}.away`, copy.wasm);
    near(volume((await copy.package.mesh(ball(12), { iso: 100 })).mesh), ballVolume(12), 0.03);
    rmSync(copy.folder, { recursive: true });
  });
  it("ends a run where it can't be linked", { timeout: 60_000 }, async () => {
    // imports x.y, a function that nothing provides
    const foreign = [0, 0x61, 0x73, 0x6d, 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 2, 7, 1, 1, 0x78, 1, 0x79, 0, 0];
    const copy = await copied((wasm) => writeFileSync(wasm, new Uint8Array(foreign)));
    await assert.rejects(copy.package.mesh(ball(12), { iso: 100 }), { name: "AdaptisoError", exitCode: 4, message: /^adaptiso-mesh: .*"x"/ });
    rmSync(copy.folder, { recursive: true });
  });
});
