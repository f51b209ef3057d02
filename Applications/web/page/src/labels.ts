/** The tab Labels: adaptiso-labels of a segmentation. */
import { byId, formatCount, make, showDrawing, showGiven, swatch } from "./dom";
import { takeFiles } from "./drop";
import type { ImageFacts, InputFile, RunResult } from "./protocol";
import { memoryOf, type Scan, sizeOf } from "./scan";
import { exampleHead } from "./nifti";
import { isChecked, kReport, number, type Page, reportOf, type Run, type Task, tellLeftOut } from "./task";
import type { Color, Surface } from "./painter";
import { zip } from "./zip";

interface Region { label: number; name: string; isNamed: boolean; color: string; voxels: number; volumeMm3: number;
  triangles: number; file: string }
interface LabelsReport { regions: Region[]; walls: { triangles: number; errorBoundMm: number } }

/** Of "#rrggbb". */
const colorOf = ({ color }: Region): Color => [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16)) as Color;

export class LabelsTab {
  private readonly task: Task;
  private names: InputFile | undefined;
  private shown: ImageFacts | undefined;

  constructor(private readonly page: Page, private readonly scan: Scan) {
    this.task = scan.taskOf("labels", page);
    takeFiles(byId("labels-drop"), (files) => scan.take(this.task, files, true));
    scan.onChange(() => {
      if (scan.facts === undefined || scan.facts === this.shown) return;
      byId("labels-scan").textContent = scan.path;
      if (this.shown !== undefined) this.setNames(undefined);  // they were the other map's
      this.shown = scan.facts;
    });
    byId("labels-example").addEventListener("click", async () => {
      if (await scan.take(this.task, [{ path: "example-labels.nii", data: exampleHead(true) }], true)) await this.make();
    });
    takeFiles(byId("names-drop"), (files) => { this.setNames(files[0]); tellLeftOut(this.task, files, 1); });
    byId("labels-form").addEventListener("submit", (event) => { event.preventDefault(); this.make(); });
  }

  private setNames(file: InputFile | undefined): void {
    this.names = file;
    showGiven(byId("names-name"), file === undefined ? [] : [file.path], () => this.setNames(undefined));
  }

  private runOf(facts: ImageFacts): Run {
    const scan = this.scan, files = [...scan.files], args = [scan.path, ...scan.readArgs];
    if (this.names !== undefined) {
      files.push({ ...this.names, path: `names/${this.names.path}` });
      args.push("--names", `names/${this.names.path}`);
    }
    if (number("labels-error") !== "") args.push("--max-error", number("labels-error"));
    if (number("labels-list") !== "") args.push("--labels", number("labels-list"));
    if (isChecked("file-names")) args.push("--file-names", "name");
    args.push("--format", byId<HTMLSelectElement>("labels-format").value, "-o", "regions-of-map", "--json", kReport);
    return { program: "adaptiso-labels", args, files,
      memoryBytes: scan.looker.crossedEdges(Number.NaN).then((faces) => memoryOf.labels(facts, faces) + sizeOf(files)),
      shownArgs: args.map((arg) => arg.startsWith("names/") ? arg.slice("names/".length) : arg) };
  }

  async make(): Promise<void> {
    const { facts } = this.scan;
    if (facts === undefined) return this.task.refuse("Give a label map first.");
    const run = this.runOf(facts), done = await this.task.run(run);
    if (done !== undefined && done.exitCode === 0) await this.show(run, done, facts);
  }

  private async show(run: Run, done: RunResult, facts: ImageFacts): Promise<void> {
    const report = reportOf(done) as unknown as LabelsReport, { regions } = report;
    const files = done.files.filter((file) => file.path.startsWith("regions-of-map/"));
    const list = make("ul", { className: "regions" });
    if (facts !== this.scan.facts) return;  // another was opened meanwhile
    await this.task.show(`${formatCount(regions.length)} regions, ${formatCount(report.walls.triangles)} triangles; no wall farther than `
      + `${Number(report.walls.errorBoundMm.toPrecision(3))} mm from its full resolution (proved); closed; no triangles cross`, run, done, [], [list]);
    showDrawing();
    this.task.addSave(`Save all regions (${files.length} files, zip)`, "regions.zip", () => zip(files), true);
    const surfaces: Surface[] = [];
    const colors = new Map(regions.map((region) => [region.label, colorOf(region)]));
    if (facts.labels.length > 0) {
      await (await this.page.view())?.setLabelColors(facts.labels.map((label, n) => colors.get(label) ?? facts.labelColors[n]));
    }
    for (const region of regions) {
      const color = colorOf(region), index = surfaces.length;
      const file = files.find((each) => each.path.endsWith(region.file));
      if (file === undefined) continue;
      const name = region.name || `label ${region.label}`;
      const opened = await this.scan.looker.mesh({ path: `shown/${file.path.split("/").at(-1)}`, data: file.bytes.slice() },
        "adaptiso-labels");
      surfaces.push({ name, shape: opened.shape, color, opacity: 1 });
      const box = make("input", { type: "checkbox", checked: true });
      box.addEventListener("change", async () => (await this.page.view())?.setShown(index, box.checked));
      list.append(make("li", {}, make("label", {}, box, swatch(color), ` ${name}: ${formatCount(Math.round(region.volumeMm3))} mm³`)));
    }
    if (facts !== this.scan.facts) return;
    this.task.addGlb("regions.glb", surfaces);
    await (await this.page.view())?.showSurfaces(surfaces);
    document.body.dataset.shown = "regions";
  }
}
