/** The tab Head model: adaptiso-bem of a T1, with or without a mask, or of a label map. */
import { byId, formatCount, make, showDrawing, showGiven } from "./dom";
import { takeFiles } from "./drop";
import type { ImageFacts, InputFile, RunResult } from "./protocol";
import { memoryOf, type Scan } from "./scan";
import { count, isChecked, kReport, number, type Page, reportOf, type Run, type Task, tellLeftOut } from "./task";
import { exampleHead, kExampleTissues } from "./nifti";
import type { Color, Surface } from "./painter";
import { zip } from "./zip";

const kColors: Color[] = [[230, 120, 110], [240, 190, 120], [110, 190, 240], [150, 220, 150]];
interface HeadReport { notes: string[]; surfaces: { name: string; vertices: number; triangles: number;
  crossingPairs: number; seenShare: number | null }[] }

export class HeadTab {
  private readonly task: Task;
  private mask: InputFile | undefined;
  private shown: ImageFacts | undefined;

  constructor(private readonly page: Page, private readonly scan: Scan) {
    this.task = scan.taskOf("head", page);
    takeFiles(byId("mask-box"), (files) => { this.setMask(files[0]); tellLeftOut(this.task, files, 1); });
    byId("head-form").addEventListener("submit", (event) => { event.preventDefault(); this.make(); });
    byId("source").addEventListener("change", () => this.showSource());
    byId("head-example").addEventListener("click", async () => {
      byId<HTMLSelectElement>("source").value = "labels";
      byId<HTMLSelectElement>("preset").value = "";
      byId<HTMLInputElement>("tissues").value = kExampleTissues;
      this.showSource();
      if (await scan.take(this.task, [{ path: "example-labels.nii", data: exampleHead(true) }], true)) await this.make();
    });
    takeFiles(byId("head-drop"), (files) => scan.take(this.task, files));
    scan.onChange(() => {
      if (scan.facts === undefined || scan.facts === this.shown) return;
      byId("head-scan").textContent = scan.path;
      if (this.shown !== undefined) this.setMask(undefined);  // it was the other scan's
      this.shown = scan.facts;
    });
    this.showSource();
  }

  private setMask(file: InputFile | undefined): void {
    this.mask = file;
    showGiven(byId("mask-name"), file === undefined ? [] : [file.path], () => this.setMask(undefined));
  }

  private showSource(): void {
    const isLabels = byId<HTMLSelectElement>("source").value === "labels";
    byId("mask-box").hidden = isLabels;
    byId("tissues-box").hidden = !isLabels;
  }

  private runOf(facts: ImageFacts): Run {
    const scan = this.scan, source = byId<HTMLSelectElement>("source").value;
    const files = [...scan.files], args = [source === "labels" ? "--labels" : source === "ct" ? "--ct" : "--t1", scan.path,
      ...scan.readArgs];
    if (source === "t1" && this.mask !== undefined) {
      files.push({ ...this.mask, path: `mask/${this.mask.path}` });
      args.push("--brain-mask", `mask/${this.mask.path}`);
    }
    if (source === "labels") {
      const preset = byId<HTMLSelectElement>("preset").value;
      if (preset !== "") args.push("--preset", preset);
      else for (const tissue of number("tissues").split(/\s+/).filter((text) => text !== "")) args.push("--tissue", tissue);
    }
    args.push("--layers", byId<HTMLSelectElement>("layers").value, "--vertices", count("vertices"));
    if (isChecked("fif")) args.push("--fif");
    if (isChecked("head-gifti")) args.push("--gifti");
    args.push("-o", "model", "--json", kReport);
    const shownArgs = args.map((arg) => arg.startsWith("mask/") ? arg.slice("mask/".length) : arg);
    return { program: "adaptiso-bem", args, files, shownArgs, memoryBytes: memoryOf.head(facts, source === "labels") };
  }

  async make(): Promise<void> {
    const { facts } = this.scan;
    if (facts === undefined) return this.task.refuse("Give a scan first.");
    const run = this.runOf(facts), done = await this.task.run(run);
    if (done !== undefined && facts === this.scan.facts) await this.show(facts, run, done);
  }

  private async show(facts: ImageFacts, run: Run, done: RunResult): Promise<void> {
    const report = reportOf(done) as unknown as HeadReport | undefined;
    const model = done.files.filter((file) => file.path.startsWith("model/"));
    if (report?.surfaces === undefined || done.exitCode !== 0) return;
    const title = `${report.surfaces.length} surfaces of ${report.surfaces.map((s) => formatCount(s.vertices)).join(", ")} `
      + "vertices, closed, each inside the next; no triangles cross"
      + report.surfaces.filter(({ seenShare }) => (seenShare ?? 1) < 0.5)
        .map(({ name, seenShare }) => `; ${name.replace("_", " ")} ${Math.round(100 - 100 * (seenShare ?? 0))} % guessed`).join("");
    const rows = report.surfaces.map((surface) => make("tr", {}, make("th", { scope: "row" }, surface.name.replace("_", " ")),
      make("td", {}, formatCount(surface.triangles)),
      make("td", { className: (surface.seenShare ?? 1) < 0.5 ? "guessed" : "seen" },
        surface.seenShare === null ? "as it came" : `${Math.round(100 * surface.seenShare)} % seen, `
          + `${Math.round(100 - 100 * surface.seenShare)} % guessed`)));
    const head = make("tr", {}, ...["surface", "triangles", "in the image"].map((text) => make("th", { scope: "col" }, text)));
    await this.task.show(title, run, done, [], [
      make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows)),
      ...(report.notes.length > 0 ? [make("ul", { className: "notes" }, ...report.notes.map((note) => make("li", {}, note)))] : [])]);
    showDrawing();
    this.task.addSave(`Save the model (${model.length} files, zip)`, "model.zip", () => zip(model), true);
    const surfaces: Surface[] = [];
    for (const [n, surface] of report.surfaces.entries()) {
      const file = model.find((each) => each.path === `model/${surface.name}.surf`);
      if (file === undefined) continue;
      const opened = await this.scan.looker.mesh({ path: `shown/${surface.name}.surf`, data: file.bytes.slice() }, "adaptiso-bem");
      surfaces.push({ name: surface.name.replace("_", " "), shape: opened.shape, color: kColors[n], opacity: n + 1 === report.surfaces.length ? 0.35 : 1 });
    }
    if (facts !== this.scan.facts) return;  // another was opened meanwhile
    this.task.addGlb("model.glb", surfaces);
    const shades = this.shown?.labels.map((_, n, { length }): Color => Array(3).fill(60 + 120 * n / Math.max(1, length - 1)) as Color) ?? [];
    if (shades.length > 0) await (await this.page.view())?.setLabelColors(shades);  // colours are the surfaces' here
    await (await this.page.view())?.showSurfaces(surfaces);
    document.body.dataset.shown = "model";
  }
}
