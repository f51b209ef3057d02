/** The image that the tabs Mesh, Head model and Labels work on. */
import { byId, formatBytes, make } from "./dom";
import { asInput, kMasks, kSlices } from "./drop";
import { Cancelled, type Looker, Refused } from "./engine";
import { nifti } from "./nifti";
import type { ImageFacts, InputFile, ReadOptions, Series } from "./protocol";
import { kMostMemory, kProgramBytes, type Page, Task, tooLarge } from "./task";

const sum = (numbers: number[]): number => numbers.reduce((all, each) => all + each, 0);
/** Bytes as they lie in the files. */
export const sizeOf = (files: InputFile[]): number => sum(files.map(({ data }) => data instanceof Blob ? data.size : data.length));

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
  private read: ReadOptions = {};
  readonly looker: Looker;
  private readonly listeners: (() => void)[] = [];

  constructor(private readonly page: Page) { this.looker = page.engine.looker(); }

  private readonly tasks: Task[] = [];
  /** The task of a tab that works on the image. Opening another image ends its run and hides its result. */
  taskOf(id: string, page: Page): Task {
    const task = new Task(id, page);
    this.tasks.push(task);
    return task;
  }

  /** An image is being read; the one before is there until then. */
  isReading = false;

  /** Calls `listener` when an image begins to be read (`isReading`), and when it is open or was refused. */
  onChange(listener: () => void): void { this.listeners.push(listener); }

  /** Arguments of every program that reads it. */
  get readArgs(): string[] {
    return Object.entries(this.read).flatMap(([name, value]) => [`--${name}`, String(value)]);
  }

  /** Opens what was given on a tab; where it is refused, the tab says why and offers the choice that is needed. */
  async take(task: Task, given: InputFile[], isLabels = false, read: ReadOptions = {}): Promise<boolean> {
    task.refuse("");
    const refused = await this.open(given, isLabels, read), choices: HTMLElement[] = [];
    if (refused === undefined) return this.facts !== undefined;
    const { line } = refused;
    const add = (label: string, chosen: () => ReadOptions | undefined): void => {
      const button = make("button", { type: "button" }, label);
      button.addEventListener("click", () => {
        const wanted = chosen();
        if (wanted !== undefined) void this.take(task, given, isLabels, wanted);
      });
      choices.push(button);
    };
    if (refused.volumes !== null) {
      const box = make("input", { type: "number", min: "0", max: String(refused.volumes - 1), value: "0", required: true });
      choices.push(make("label", {}, "Volume ", box));
      add("Open it", () => (box.reportValidity() ? { "volume-index": Number(box.value) } : undefined));
    } else if (refused.series.length > 0) {
      choices.push(make("p", {}, make("strong", {}, `${refused.series.length} series: choose one`)));
      for (const each of refused.series.filter(({ fault }) => fault === "")) add(rowOf(each), () => ({ series: String(each.number) }));
      choices.push(make("details", {}, make("summary", {}, "More of each"),
        make("ul", {}, ...refused.series.map((each) => make("li", {}, moreOf(each))))));
      task.refuse("", choices);  // it is a question
      return false;
    }
    task.refuse(line, choices, given.flatMap(({ path }) => path.split("/")).filter((name) => name !== ""));
    return false;
  }

  /** \return why not; nothing: it is open, or another was asked for meanwhile. A refused one changes nothing */
  private async open(given: InputFile[], isLabels: boolean, read: ReadOptions): Promise<Refused | undefined> {
    const turn = ++this.turn;
    this.isReading = true;
    for (const listener of this.listeners) listener();
    byId("facts").textContent = "reading ...";
    byId("facts-box").hidden = false;
    let path = "";
    try {
      const input = asInput(given, isLabels), { files } = input;
      path = input.path;
      const sizes = await Promise.all(files.map(unpackedBytes));
      const bytes = isLabels ? Math.max(...sizes) + sizeOf(files) : sum(sizes);  // masks are read one after another
      if (turn !== this.turn) throw new Cancelled();
      const need = kProgramBytes + bytes;
      if (need > kMostMemory) throw new Refused(tooLarge(path, need, "adaptiso-mesh, or adaptiso-giant"), 3);
      const { facts, shades } = await this.looker.open({ files, path, read, isLabels });
      for (const each of this.tasks) each.clear();
      Object.assign(this, { facts, files, path, read, isReading: false });
      this.tell(facts);
      for (const listener of this.listeners) listener();
      const view = await this.page.view();
      await view?.showImage(nifti(facts.shownSize, facts.shownAffine, shades, facts.labels.length > 0 ? 2 : 1), facts.labelColors);
      document.body.dataset.scan = path;
      return undefined;
    } catch (error) {
      if (turn !== this.turn) return undefined;
      this.isReading = false;
      if (this.facts !== undefined) this.tell(this.facts);
      byId("facts-box").hidden = this.facts === undefined;
      for (const listener of this.listeners) listener();
      if (error instanceof Cancelled) return undefined;
      if (!(error instanceof Refused)) return new Refused((error as Error).message, 3);
      const named = path === kSlices ? error.line.replace(`${kSlices}:`, `${given.length} files:`)
        : path === kMasks ? error.line.replaceAll(`${kMasks}/`, "") : error.line;
      return new Refused(named, error.exitCode, error.series, error.volumes);
    }
  }
  private turn = 0;

  private tell(facts: ImageFacts): void {
    const spacing = facts.geometry.spacingMm.map((mm) => Number(mm.toPrecision(4)));
    byId("facts").textContent = `${this.path}: ${facts.format}, ${facts.geometry.sizeVoxels.join(" × ")} voxels of `
      + `${spacing.join(" × ")} mm, ${facts.orientation}, ${facts.type}, ${formatBytes(facts.bytes)}; values `
      + `${Number(facts.minimum.toPrecision(6))} to ${Number(facts.maximum.toPrecision(6))}`;
    byId("scan-warnings").replaceChildren(...facts.warnings.map((text) => make("li", {}, text,
      ...(/--image-space/.test(text) ? [" ", make("span", { className: "hint" }, "Not possible in this page: npx adaptiso mesh ... --image-space")] : []))));
  }
}

/** "2: MR, T1 MPRAGE; 176 slices, 1 × 1 × 1 mm" */
function rowOf({ number, modality, description, size, volumes, spacingMm }: Series): string {
  const mm = spacingMm.map((each) => each > 0 ? String(Number(each.toPrecision(3))) : "?").join(" × ");
  const title = [modality, description].filter((text) => text !== "").join(", ");
  return `${number}: ${title === "" ? "" : `${title}; `}${volumes > 1 ? `${volumes} volumes of ` : ""}${size[2]} slices, ${mm} mm`;
}

function moreOf({ number, size, orientation, localizer, details, fault }: Series): string {
  return [`${number}: ${size[0]} × ${size[1]} voxels`, orientation, ...(localizer ? ["localizer"] : []),
    ...details.map(([key, value]) => `${key} ${value}`), ...(fault === "" ? [] : [`can't be read: ${fault}`])].join(", ");
}

/**
 * Peak memory of a run, bytes: within a quarter of what it takes, or more. Measured over ch2, ch2bet, balls and
 * lattices of 128 to 256 voxels along each axis, bytes, shorts and floats, packed or not, and four atlases.
 */
export const memoryOf = {
  /** \param edges  that the surface crosses  \param isSmoothed  the image is, into floats, before */
  mesh(facts: ImageFacts, edges: number, isByCount: boolean, isSmoothed: boolean): number {
    const extraction = (isByCount ? 210 : 280) * edges, voxels = voxelsOf(facts);
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
