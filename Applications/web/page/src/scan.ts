/** The image that the tabs Mesh, Head model and Labels work on. */
import { byId, formatBytes, formatCount, make } from "./dom";
import { asInput } from "./drop";
import { Cancelled, type Looker, Refused } from "./engine";
import { nifti } from "./nifti";
import type { ImageFacts, InputFile } from "./protocol";
import { kMostMemory, type Page, tooLarge } from "./task";

export class Scan {
  files: InputFile[] = [];
  path = "";
  facts: ImageFacts | undefined;
  volumeIndex = -1;
  series = "";
  readonly looker: Looker;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly page: Page) { this.looker = page.engine.looker(); }

  onOpen(listener: () => void): void { this.listeners.push(listener); }

  /** Arguments of every program that reads it. */
  get readArgs(): string[] {
    return [...(this.volumeIndex >= 0 ? ["--volume-index", String(this.volumeIndex)] : []),
      ...(this.series !== "" ? ["--series", this.series] : [])];
  }

  /** \return the line that says why not; empty: it is open */
  async open(given: InputFile[], isLabels = false): Promise<string> {
    const { files, path } = asInput(given);
    const bytes = files.reduce((sum, file) => sum + (file.data instanceof Blob ? file.data.size : file.data.length), 0);
    this.facts = undefined;
    this.files = files;
    this.path = path;
    byId("facts").textContent = "reading ...";
    byId("facts-box").hidden = false;
    byId("scan-warnings").replaceChildren();
    try {
      if (2 * bytes > kMostMemory) throw new Refused(tooLarge(path, 2 * bytes, "adaptiso-mesh, or adaptiso-giant"), 3);
      const { facts, shades } = await this.looker.open({ files, path, volumeIndex: this.volumeIndex, series: this.series, isLabels });
      this.facts = facts;
      this.tell(facts);
      for (const listener of this.listeners) listener();
      const view = await this.page.view();
      await view?.showImage(nifti(facts.shownSize, facts.shownAffine, shades), isLabels);
      document.body.dataset.scan = path;
      return "";
    } catch (error) {
      if (error instanceof Cancelled) return "";
      byId("facts-box").hidden = true;
      return error instanceof Refused ? error.line : String(error);
    }
  }

  private tell(facts: ImageFacts): void {
    const spacing = facts.geometry.spacingMm.map((mm) => Number(mm.toPrecision(4)));
    byId("facts").textContent = `${this.path}: ${facts.format}, ${facts.geometry.sizeVoxels.join(" × ")} voxels of `
      + `${spacing.join(" × ")} mm, ${facts.orientation}, ${facts.type}, ${formatBytes(facts.bytes)}; values `
      + `${Number(facts.minimum.toPrecision(6))} to ${Number(facts.maximum.toPrecision(6))}`;
    byId("scan-warnings").replaceChildren(...facts.warnings.map((text) => make("li", {}, text)));
  }
}

/** An estimate, not measured: the adaptive method takes about 110 bytes a triangle of marching cubes beside the image. */
export function memoryOf(facts: ImageFacts, previewTriangles: number): number {
  return 3 * facts.bytes + 110 * previewTriangles * facts.previewStep ** 2 + 30e6;
}
export { formatCount };
