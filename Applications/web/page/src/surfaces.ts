/** The tabs Check, Mend, Simplify and Compare: of meshes that are there. */
import { byId, formatCount, make, showDrawing, showGiven } from "./dom";
import { stemOf, takeFiles } from "./drop";
import { type Looker, Refused } from "./engine";
import type { InputFile, OpenedMesh, Shape } from "./protocol";
import { insideOf } from "./shape";
import { count, isChecked, kProgramBytes, kReport, number, outputsOf, type Page, reportOf, type Run, Task, tellLeftOut } from "./task";
import type { Color, Surface } from "./painter";

const kColor: Color = [240, 190, 120], kOther: Color = [110, 190, 240];

/** A tab of meshes: what they share. */
class Meshes {
  readonly task: Task;
  readonly files: InputFile[] = [];
  shown: Surface[] = [];
  private readonly looker: Looker;

  constructor(id: string, readonly page: Page, most: number, make: () => Promise<void>) {
    this.task = new Task(id, page);
    this.looker = page.engine.looker();
    takeFiles(byId(`${id}-drop`), (given) => { this.taking = this.taking.then(() => this.take(given, most)).catch((error) => this.task.refuse(this.lineOf(error))); });
    byId(`${id}-form`).addEventListener("submit", (event) => { event.preventDefault(); void this.taking.then(make); });
  }
  private taking = Promise.resolve();

  private async take(given: InputFile[], most: number): Promise<void> {
    const good: InputFile[] = [];
    let refusal = "";
    for (const file of given.slice(0, most)) {  // one that can't be read takes nothing away
      try {
        await this.open(file);
        good.push(file);
      } catch (error) {
        refusal = this.lineOf(error);
      }
    }
    if (good.length > 0) {
      this.task.cancel();
      this.files.push(...good);
      this.files.splice(0, Math.max(0, this.files.length - most));
      await this.changed();
    }
    tellLeftOut(this.task, given, most);
    if (refusal !== "") this.task.refuse(refusal, [], given.map(({ path }) => path));
  }

  private async changed(): Promise<void> {
    showGiven(byId(`${this.task.id}-names`), this.files.map((file) => file.path), (n) => {
      this.files.splice(n, 1);
      void this.changed();
    });
    this.task.part(".result").hidden = true;
    this.task.refuse("");
    this.shown = [];
    await this.show(this.apart);
  }

  /** The files at their own names; in folders 1, 2, ... where two have the same. */
  get apart(): InputFile[] {
    if (new Set(this.files.map(({ path }) => path)).size === this.files.length) return this.files;
    return this.files.map((file, n) => ({ ...file, path: `${n + 1}/${file.path}` }));
  }

  /** Peak memory of a run on them, bytes: within a quarter, measured over STL and PLY of 786,372 triangles. */
  get memoryBytes(): number {
    return kProgramBytes + 265 * this.shown.reduce((sum, { shape }) => sum + shape.triangles.length / 3, 0);
  }

  private readonly opened = new WeakMap<Blob | Uint8Array, Promise<OpenedMesh>>();
  async open(file: InputFile): Promise<OpenedMesh> {
    const found = this.opened.get(file.data);
    if (found !== undefined) return found;
    const data = file.data instanceof Blob ? file.data : file.data.slice();
    const opened = this.looker.mesh({ path: `shown/${file.path.split("/").at(-1)}`, data }, `adaptiso-${this.task.id}`);
    this.opened.set(file.data, opened);
    opened.catch(() => this.opened.delete(file.data));
    return opened;
  }

  /** Why it can't be read. */
  private lineOf(error: unknown): string {
    return error instanceof Refused ? error.line.replaceAll("shown/", "") : String(error);
  }

  /** What can be read; the program says what can't. */
  async show(files: InputFile[], paint?: (shape: Shape) => Uint8Array | undefined): Promise<Surface[]> {
    const surfaces: Surface[] = [];
    showDrawing();
    for (const [n, file] of files.entries()) {
      try {
        const { shape } = await this.open(file);
        surfaces.push({ name: file.path, shape, color: n % 2 === 0 ? kColor : kOther, opacity: 1, colors: paint?.(shape) });
      } catch (error) {
        this.task.refuse(this.lineOf(error));
      }
    }
    const view = await this.page.view();
    await view?.clear();
    if (surfaces.length === 0) return [];
    await view?.showSurfaces(surfaces);
    document.body.dataset.shown = files.map((file) => file.path).join(" ");
    this.shown = surfaces;
    return surfaces;
  }
}

interface CheckReport { surfaces: { file: string; error: string | null; passed: boolean; triangles: number; failed: string[];
  checks: { name: string; text: string; required: boolean; outcome: string; finding: string }[];
  examples: { defect: string; triangle: number | null; vertices: number[]; pointMm: number[] | null }[] }[] }

type Example = CheckReport["surfaces"][number]["examples"][number];

/** "non manifold vertex" of "nonManifoldVertex" */
const wordsOf = (key: string): string => key.replace(/[A-Z]/g, (letter) => ` ${letter.toLowerCase()}`);

/** The first few of each kind. */
function fewOfEach(examples: Example[]): Example[] {
  const kMost = 4, counts = new Map<string, number>();
  return examples.filter(({ defect }) => {
    counts.set(defect, (counts.get(defect) ?? 0) + 1);
    return (counts.get(defect) ?? 0) <= kMost;
  });
}

/** Where it is in the shape that is shown, whatever the file's frame is. */
function placeOf({ triangle, vertices, pointMm }: Example, shape: Shape | undefined): number[] | null {
  if (shape === undefined) return pointMm;
  const corners = vertices?.length > 0 ? [vertices[0]] : triangle === null ? [] : Array.from(shape.triangles.subarray(3 * triangle, 3 * triangle + 3));
  if (corners.length === 0 || corners.some((corner) => 3 * corner >= shape.points.length)) return pointMm;
  return [0, 1, 2].map((axis) => corners.reduce((sum, corner) => sum + shape.points[3 * corner + axis], 0) / corners.length);
}

export class CheckTab {
  private readonly meshes: Meshes;
  constructor(page: Page) { this.meshes = new Meshes("check", page, 8, () => this.make()); }

  private async make(): Promise<void> {
    const { task, apart: files, page, shown } = this.meshes;
    if (files.length === 0) return task.refuse("Give a mesh first.");
    const args = files.map((file) => file.path);
    if (byId<HTMLInputElement>("nested").checked) args.push("--nested");
    const profile = byId<HTMLSelectElement>("profile").value;
    args.push(...(profile === "" ? [] : ["--profile", profile]), "--json", kReport);
    const run: Run = { program: "adaptiso-check", args, files, memoryBytes: this.meshes.memoryBytes }, done = await task.run(run);
    const report = done === undefined ? undefined : reportOf(done) as unknown as CheckReport | undefined;
    if (done === undefined || report?.surfaces === undefined) return;
    const bad = report.surfaces.filter((surface) => !surface.passed).length;
    const title = bad === 0 ? `${formatCount(report.surfaces.length)} of ${formatCount(report.surfaces.length)} surfaces pass`
      : `${formatCount(bad)} of ${formatCount(report.surfaces.length)} surfaces fail`;
    const details = report.surfaces.map((surface, n) => {
      const list = make("ul", { className: "checks" });
      for (const check of surface.checks ?? []) {
        list.append(make("li", { className: check.outcome },
          `${check.outcome === "passed" ? "✓" : check.outcome === "failed" ? "✗" : "?"} ${check.text}`
          + `${check.finding === "" ? "" : `: ${check.finding}`}`));
      }
      const places = make("p", { className: "places" });
      const shape = shown.find(({ name }) => name === files[n].path)?.shape;
      for (const example of fewOfEach(surface.examples ?? [])) {
        const point = placeOf(example, shape);
        if (point === null || !point.every(Number.isFinite)) continue;
        const button = make("button", { type: "button" }, `Show ${wordsOf(example.defect)}`);
        button.addEventListener("click", async () => (await page.view())?.moveTo(point));
        places.append(button);
      }
      return make("details", { open: !surface.passed }, make("summary", {}, `${files[n].path}: ${surface.error ?? (surface.passed
        ? "passes" : `fails ${surface.failed.map((key) => surface.checks.find(({ name }) => name === key)?.text ?? key).join(", ")}`)}`), list, places);
    });
    await task.show(title, run, done, [], details);
    const file = done.files.find((each) => each.path === kReport);
    if (file !== undefined) task.addSave("Save the report (JSON)", "check.json", () => file.bytes, true);
  }
}

interface Place { spanMm: number }

export class MendTab {
  private readonly meshes: Meshes;
  constructor(page: Page) { this.meshes = new Meshes("mend", page, 1, () => this.make()); }

  private async make(): Promise<void> {
    const { task, files } = this.meshes;
    if (files.length === 0) return task.refuse("Give a mesh first.");
    const [file] = files, output = `${stemOf(file.path)}-mended${byId<HTMLSelectElement>("mend-format").value}`;
    const args = [file.path];
    for (const [option, id] of [["--max-error", "mend-error"], ["--max-hole", "mend-hole"]]) {
      if (byId<HTMLInputElement>(id).value !== "") args.push(option, number(id));
    }
    if (isChecked("mend-ball")) args.push("--ball");
    args.push("-o", output, "--json", kReport);
    const run: Run = { program: "adaptiso-mend", args, files, memoryBytes: this.meshes.memoryBytes }, done = await task.run(run);
    if (done === undefined || done.exitCode !== 0) return;
    const report = reportOf(done) as { found: { sound: boolean }; output: { triangles: number; keptTriangles: number; resultToInputMm: number;
      inputToResultMm: number; filled: Place[]; inner: Place[]; thin: Place[]; cutHandles: Place[]; filledHandles: Place[] } };
    const made = report.output, [result] = outputsOf(done);
    const counted = (places: Place[], one: string, many: string): string[] => (places.length === 0 ? [] : [`${places.length} ${places.length === 1 ? one : many}`]);
    const changes = [...counted(made.filled, "hole closed", "holes closed"), ...counted(made.inner, "inner part dropped", "inner parts dropped"),
      ...counted(made.thin, "thin part dropped", "thin parts dropped"), ...counted(made.cutHandles, "handle cut", "handles cut"),
      ...counted(made.filledHandles, "handle filled", "handles filled")];
    const most = Math.max(made.resultToInputMm, made.inputToResultMm);
    await task.show(report.found.sound ? `${file.path} is sound: it stays as it is`
      : `A sound solid of ${formatCount(made.triangles)} triangles, ${formatCount(made.keptTriangles)} of them as they were`
        + `${changes.length === 0 ? "" : `; ${changes.join(", ")}`}; no other point farther than ${Number(most.toPrecision(3))} mm from ${file.path} (proved)`,
    run, done, [result]);
    task.addSave(`Save ${result.path}`, result.path, () => result.bytes, true);
    task.addGlb(`${stemOf(result.path)}.glb`, await this.meshes.show([{ path: result.path, data: result.bytes }]));
  }
}

export class SimplifyTab {
  private readonly meshes: Meshes;
  constructor(page: Page) { this.meshes = new Meshes("simplify", page, 1, () => this.make()); }

  private async make(): Promise<void> {
    const { task, files } = this.meshes;
    if (files.length === 0) return task.refuse("Give a mesh first.");
    const [file] = files, format = byId<HTMLSelectElement>("simplify-format").value;
    const args = [file.path];
    if (isChecked("simplify-by-count")) args.push("--triangles", count("simplify-triangles"));
    else args.push("--max-error", number("simplify-error"));
    const output = `${stemOf(file.path)}-simple${format}`;
    args.push("-o", output, "--json", kReport);
    const run: Run = { program: "adaptiso-simplify", args, files, memoryBytes: this.meshes.memoryBytes }, done = await task.run(run);
    if (done === undefined || done.exitCode !== 0) return;
    const report = reportOf(done) as { input: { triangles: number }; output: { triangles: number; errorBoundMm: number | null } };
    const [result] = outputsOf(done);
    await task.show(`${formatCount(report.output.triangles)} triangles of ${formatCount(report.input.triangles)}`
      + (report.output.errorBoundMm === null ? "" : `; no point farther than ${Number(report.output.errorBoundMm.toPrecision(3))} mm from ${file.path} (proved)`),
      run, done, [result]);
    task.addSave(`Save ${result.path}`, result.path, () => result.bytes, true);
    task.addGlb(`${stemOf(result.path)}.glb`, await this.meshes.show([{ path: result.path, data: result.bytes }]));
  }
}

/** Colours of places inside, at and outside the other mesh. Red is taken: the back of a triangle is red. */
const kInward: Color = [33, 102, 172], kNone: Color = [240, 240, 240], kOutward: Color = [230, 97, 1];
const mixed = (share: number): Color =>
  kNone.map((none, at) => Math.round(none + Math.abs(share) * ((share < 0 ? kInward : kOutward)[at] - none))) as Color;

export class CompareTab {
  private readonly meshes: Meshes;
  constructor(page: Page) { this.meshes = new Meshes("compare", page, 2, () => this.make()); }

  private async make(): Promise<void> {
    const { task, apart: files } = this.meshes;
    if (files.length !== 2) return task.refuse("Give two meshes first.");
    let output = "distance.vtp";
    while (files.some(({ path }) => path === output)) output = `new-${output}`;
    const args = [...files.map((file) => file.path), "--colored", output, "--json", kReport];
    const run: Run = { program: "adaptiso-compare", args, files, memoryBytes: this.meshes.memoryBytes }, done = await task.run(run);
    if (done === undefined || done.exitCode !== 0) return;
    const { b, distances: { combined, aToB } } = reportOf(done) as { b: { volumeMm3: number | null };
      distances: Record<string, { meanMm: number; p95Mm: number; maxMm: number } | null> };
    const all = combined ?? aToB, mm = (value: number): string => `${Number(value.toPrecision(3))} mm`;
    if (all === null) return;
    await task.show(`mean ${mm(all.meanMm)}, 95 % within ${mm(all.p95Mm)}, maximum ${mm(all.maxMm)}`, run, done, outputsOf(done));
    const [colored] = outputsOf(done), isSigned = b.volumeMm3 !== null;  // an open one has no inside
    const isInside = isSigned ? insideOf((await this.meshes.open(files[1])).shape) : () => false;
    task.addSave(`Save ${colored.path}`, colored.path, () => colored.bytes, true);
    task.addGlb("distance.glb", await this.meshes.show([{ path: colored.path, data: colored.bytes }], (shape) => {
      if (shape.values === null) return undefined;
      const most = shape.values.reduce((a, b) => Math.max(a, Math.abs(b)), 0) || 1, colors = new Uint8Array(4 * shape.values.length);
      const scale = make("span", { className: "scale" });
      scale.style.background = `linear-gradient(to right, ${(isSigned ? [-1, 0, 1] : [0, 1]).map((share) => `rgb(${mixed(share).join(" ")})`).join(", ")})`;
      task.part(".verdict").after(make("p", { className: "hint" }, isSigned ? `${mm(most)} inside` : "0 mm", scale,
        `${mm(most)} ${isSigned ? "outside" : "from"} ${files[1].path}`));
      shape.values.forEach((value, n) => {
        const [x, y, z] = shape.points.subarray(3 * n);
        colors.set([...mixed(isInside(x, y, z) ? -value / most : value / most), 255], 4 * n);
      });
      return colors;
    }));
  }
}
