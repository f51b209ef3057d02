/** The tab Mesh: an isosurface of the scan. */
import { byId, formatCount, showDrawing } from "./dom";
import { stemOf, takeFiles } from "./drop";
import { Cancelled } from "./engine";
import { Histogram } from "./histogram";
import { exampleHead } from "./nifti";
import type { ImageFacts, RunResult, Shape } from "./protocol";
import { memoryOf, type Scan } from "./scan";
import { countPieces } from "./shape";
import { count, isChecked, isNumber, kReport, number, outputsOf, type Page, reportOf, type Run, type Task } from "./task";
import type { Color, Surface } from "./painter";

const kColor: Color = [240, 190, 120], kPreview: Color = [110, 190, 240];
interface SurfaceReport { triangles: number; errorBoundMm: number | null;
  componentCount: number; components: { volumeMm3: number | null }[];
  soundness: { closed: boolean; crossingPairs: number | null } }

/** "3 pieces, 2 cavities"; of more than a report lists, "207 pieces and cavities". */
function piecesOf({ componentCount, components }: SurfaceReport): string {
  if (componentCount > components.length) return `${formatCount(componentCount)} pieces and cavities`;
  const cavities = components.filter(({ volumeMm3 }) => (volumeMm3 ?? 0) < 0).length, pieces = componentCount - cavities;
  return `${pieces} ${pieces === 1 ? "piece" : "pieces"}${cavities > 0 ? `, ${cavities} ${cavities === 1 ? "cavity" : "cavities"}` : ""}`;
}

export class MeshTab {
  private readonly task: Task;
  private readonly histogram: Histogram;
  private previewTriangles = 0;
  private wanted: number | undefined;
  private isPreviewing = false;
  private shown: ImageFacts | undefined;

  constructor(private readonly page: Page, private readonly scan: Scan) {
    this.task = scan.taskOf("mesh", page);
    this.histogram = new Histogram(byId<HTMLCanvasElement>("histogram"), (value) => this.setIsovalue(this.rounded(value)));
    takeFiles(byId("drop"), (files) => scan.take(this.task, files));
    byId("example").addEventListener("click", () => this.openExample());
    byId("auto").addEventListener("click", () => { if (scan.facts?.otsu != null) this.setIsovalue(this.rounded(scan.facts.otsu)); });
    byId("iso").addEventListener("change", () => { if (isNumber(number("iso"))) this.setIsovalue(Number(number("iso"))); });
    byId("iso-slider").addEventListener("input", () => this.setIsovalue(this.rounded(Number(number("iso-slider")))));
    byId("mesh-form").addEventListener("submit", (event) => { event.preventDefault(); this.make(); });
    scan.onChange(() => this.opened());
    this.setReady(false);
  }

  async openExample(): Promise<void> {
    if (await this.scan.take(this.task, [{ path: "example.nii", data: exampleHead() }])) await this.make();
  }

  private opened(): void {
    const facts = this.scan.facts;
    this.setReady(facts !== undefined);
    if (facts === undefined || facts === this.shown) return;
    this.shown = facts;
    const slider = byId<HTMLInputElement>("iso-slider");
    slider.min = String(facts.histogram?.lower ?? facts.minimum);
    slider.max = String(facts.histogram?.upper ?? facts.maximum);
    slider.step = String((Number(slider.max) - Number(slider.min)) / 500 || 1);
    for (const id of ["max-error", "labels-error"]) byId<HTMLInputElement>(id).placeholder = String(Number(facts.defaultErrorMm.toPrecision(3)));
    this.histogram.show(facts);
    this.setIsovalue(this.rounded(facts.otsu ?? (facts.minimum + facts.maximum) / 2));
  }

  private setReady(isReady: boolean): void {
    byId("mesh-options").toggleAttribute("disabled", !isReady || this.scan.isReading);
    for (const id of ["scan-tools", "mesh-form"]) byId(id).hidden = !isReady;
  }

  /** To four digits of the range. */
  private rounded(value: number): number {
    const facts = this.scan.facts;
    const range = facts === undefined ? 1 : facts.maximum - facts.minimum;
    const digits = Math.max(0, Math.ceil(Math.log10(2000 / Math.max(range, 1e-300))));
    return Number(value.toFixed(Math.min(digits, 20)));
  }

  private setIsovalue(value: number): void {
    byId<HTMLInputElement>("iso").value = String(value);
    byId<HTMLInputElement>("iso-slider").value = String(value);
    this.histogram.mark(value);
    this.wanted = value;
    void this.preview();
  }

  /** The preview follows the slider: one at a time, the latest wish next. */
  private async preview(): Promise<void> {
    if (this.isPreviewing) return;
    this.isPreviewing = true;
    try {
      while (this.wanted !== undefined) {
        const isovalue = this.wanted, begin = performance.now();
        this.wanted = undefined;
        try {
          const shape = await this.scan.looker.preview(isovalue);
          this.previewTriangles = shape.triangles.length / 3;
          const view = await this.page.view();
          await view?.showSurfaces([{ name: `preview at ${isovalue}`, shape, color: kPreview, opacity: 1 }]);
          const step = this.scan.facts?.previewStep ?? 1;
          byId("preview").textContent = `Preview: ${formatCount(this.previewTriangles)} triangles, not simplified`
            + (step > 1 ? `, of every ${step}${step === 2 ? "nd" : step === 3 ? "rd" : "th"} voxel` : "");
          Object.assign(byId("preview").dataset, { isovalue, milliseconds: Math.round(performance.now() - begin) });
          if (this.wanted !== undefined) continue;
          const { pieces, cavities } = countPieces(shape);
          byId("largest-drops").textContent = pieces < 2 ? "" : `drops ${formatCount(pieces - 1)} smaller`;
          byId("fill-drops").textContent = cavities < 1 ? "" : `drops ${formatCount(cavities)}`;
        } catch (error) {
          if (!(error instanceof Cancelled)) byId("preview").textContent = (error as Error).message;
        }
      }
    } finally {
      this.isPreviewing = false;
    }
  }

  private runOf(facts: ImageFacts): Run {
    const scan = this.scan, format = byId<HTMLSelectElement>("format").value, frame = byId<HTMLSelectElement>("frame").value;
    const args = [scan.path, ...scan.readArgs, "--iso", number("iso")];
    if (number("smooth") !== "") args.push("--smooth", number("smooth"));
    if (isChecked("by-count")) args.push("--triangles", count("triangles"));
    else if (number("max-error") !== "") args.push("--max-error", number("max-error"));
    if (isChecked("largest")) args.push("--largest");
    if (isChecked("fill")) args.push("--fill-cavities");
    if (frame !== "") args.push("--coordinates", frame);
    args.push("-o", `${stemOf(scan.path)}${format}`, "--json", kReport);
    const isByCount = isChecked("by-count"), isSmoothed = Number(number("smooth")) > 0;
    return { program: "adaptiso-mesh", args, files: scan.files,
      memoryBytes: isNumber(number("iso")) ? scan.looker.crossedEdges(Number(number("iso")))
        .then((edges) => memoryOf.mesh(facts, edges, isByCount, isSmoothed)) : 0 };  // the program refuses it
  }

  async make(): Promise<void> {
    const { facts } = this.scan;
    if (facts === undefined) return this.task.refuse("Give a scan first.");
    const run = this.runOf(facts), smoothedBy = Number(number("smooth")), isovalue = number("iso"), stem = stemOf(this.scan.path);
    const done = await this.task.run(run);
    if (done === undefined || done.exitCode !== 0) return;
    await this.show(facts, stem, run, done, `the isosurface at ${isovalue} of the scan${smoothedBy > 0 ? ` smoothed by ${smoothedBy} mm` : ""}`);
  }

  private async show(facts: ImageFacts, stem: string, run: Run, done: RunResult, source: string): Promise<void> {
    const [output] = outputsOf(done);
    const { surfaces: [surface] } = reportOf(done) as { surfaces: SurfaceReport[] };
    const title = [`${formatCount(surface.triangles)} triangles`,
      ...(surface.errorBoundMm === null ? [] : [`no point farther than ${Number(surface.errorBoundMm.toPrecision(3))} mm from ${source} (proved)`]),
      surface.soundness.closed ? "closed" : "open",
      surface.soundness.crossingPairs ? `${formatCount(surface.soundness.crossingPairs)} pairs of triangles cross` : "no triangles cross",
      piecesOf(surface)].join("; ");
    await this.task.show(title, run, done, [output]);
    showDrawing();
    this.task.addSave(`Save ${output.path}`, output.path, () => output.bytes, true);
    const report = done.files.find((file) => file.path === kReport);
    if (report !== undefined) this.task.addSave("Save the report (JSON)", `${stem}.json`, () => report.bytes);
    const shape: Shape = (await this.scan.looker.mesh({ path: `shown/${output.path}`, data: output.bytes.slice() }, "adaptiso-mesh")).shape;
    const view = await this.page.view();
    if (facts !== this.scan.facts) return;  // another was opened meanwhile
    const surface3d: Surface = { name: output.path, shape, color: kColor, opacity: 1 };
    this.task.addGlb(`${stem}.glb`, [surface3d]);
    await view?.showSurfaces([surface3d]);
    document.body.dataset.shown = output.path;
  }
}
