/** The image that the tabs Mesh, Head model and Labels work on. */
import { byId, formatBytes, make } from "./dom";
import { asInput } from "./drop";
import { Cancelled, type Looker, Refused } from "./engine";
import { nifti } from "./nifti";
import type { ImageFacts, InputFile } from "./protocol";
import { kMostMemory, kProgramBytes, type Page, type Task, tooLarge } from "./task";

/** Size after unpacking, bytes: gzip ends with the length of its last member, modulo 4 GiB. */
async function unpackedBytes({ data }: InputFile): Promise<number> {
  const size = data instanceof Blob ? data.size : data.length;
  if (!(data instanceof Blob) || size < 18) return size;
  const [one, other] = new Uint8Array(await data.slice(0, 2).arrayBuffer());
  if (one !== 0x1f || other !== 0x8b) return size;
  const length = new DataView(await data.slice(-4).arrayBuffer()).getUint32(0, true);
  return length < size / 2 ? size : length;  // less: several members, as BGZF's, or padding
}

export class Scan {
  files: InputFile[] = [];
  path = "";
  facts: ImageFacts | undefined;
  private volumeIndex = -1;
  private series = "";
  readonly looker: Looker;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly page: Page) { this.looker = page.engine.looker(); }

  /** Calls `listener` when an image is open, and when another begins to be opened (without `facts`). */
  onChange(listener: () => void): void { this.listeners.push(listener); }

  /** Arguments of every program that reads it. */
  get readArgs(): string[] {
    return [...(this.volumeIndex >= 0 ? ["--volume-index", String(this.volumeIndex)] : []),
      ...(this.series !== "" ? ["--series", this.series] : [])];
  }

  /** Opens what was given on a tab; where it is refused, the tab says why and offers what the line lets choose from. */
  async take(task: Task, given: InputFile[], isLabels = false, volumeIndex = -1, series = ""): Promise<boolean> {
    task.cancel();
    task.part(".result").hidden = true;
    task.refuse("");
    this.volumeIndex = volumeIndex;
    this.series = series;
    const line = await this.open(given, isLabels), choices: HTMLElement[] = [];
    const add = (label: string, index: () => number, number: string): void => {
      const button = make("button", { type: "button" }, label);
      button.addEventListener("click", () => this.take(task, given, isLabels, index(), number));
      choices.push(button);
    };
    const volumes = line.includes("--volume-index") ? /\b0 to (\d+)/.exec(line) : null;
    if (volumes !== null) {
      const box = make("input", { type: "number", min: "0", max: volumes[1], value: "0" });
      choices.push(make("label", {}, "Volume ", box));
      add("Open it", () => Number(box.value), "");
    } else if (line.includes("--series")) {
      for (const [, number, text] of line.matchAll(/[(;] ?(\d+): (.*?)(?=; \d+: |\); )/g)) add(`${number}: ${text}`, () => -1, number);
    }
    task.refuse(line, choices);
    return line === "" && this.facts !== undefined;
  }

  /** \return the line that says why not; empty: it is open, or another was opened meanwhile */
  private async open(given: InputFile[], isLabels: boolean): Promise<string> {
    const { files, path } = asInput(given);
    this.facts = undefined;
    this.files = files;
    this.path = path;
    for (const listener of this.listeners) listener();
    byId("facts").textContent = "reading ...";
    byId("facts-box").hidden = false;
    byId("scan-warnings").replaceChildren();
    try {
      const bytes = (await Promise.all(files.map(unpackedBytes))).reduce((sum, each) => sum + each, 0);
      const need = kProgramBytes + bytes;
      if (need > kMostMemory) throw new Refused(tooLarge(path, need, "adaptiso-mesh, or adaptiso-giant"), 3);
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

/**
 * Peak memory of a run, bytes: within a quarter of what it takes, or more. Measured over ch2, ch2bet, balls and
 * lattices of 128 to 256 voxels along each axis, bytes, shorts and floats, packed or not, and four atlases.
 */
export const memoryOf = {
  /** \param edges  that the surface crosses  \param isSmoothed  the image is, into floats, before */
  mesh(facts: ImageFacts, edges: number, isByCount: boolean, isSmoothed: boolean): number {
    const extraction = (isByCount ? 240 : 320) * edges, voxels = voxelsOf(facts);
    return kProgramBytes + facts.bytes + (isSmoothed ? Math.max(8 * voxels, 4 * voxels + extraction) : extraction);
  },
  /** \param faces  between voxels of different labels; thin sheets take up to three times as much */
  labels: (facts: ImageFacts, faces: number): number => kProgramBytes + facts.bytes + 575 * faces,
  /** Grows with the voxels of the image, and with those of the working grid of 1 mm. */
  head(facts: ImageFacts, isLabels: boolean): number {
    const voxels = voxelsOf(facts), mm3 = facts.geometry.spacingMm.reduce((product, mm) => product * mm, voxels);
    return kProgramBytes + facts.bytes + (isLabels ? 18 * voxels + 31 * mm3 : 8 * voxels + 42 * mm3);
  },
};
const voxelsOf = (facts: ImageFacts): number => facts.geometry.sizeVoxels.reduce((product, size) => product * size, 1);
