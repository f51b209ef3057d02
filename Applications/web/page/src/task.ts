/** What all tabs share: a form, a run of a program with its progress, and what comes out of it. */
import { byId, copy, formatBytes, formatCount, make, quoted, save, sha256 } from "./dom";
import { Cancelled, type Engine, type Job, Refused } from "./engine";
import { glb } from "./glb";
import type { Surface } from "./painter";
import type { InputFile, OutputFile, RunResult } from "./protocol";
import type { View } from "./view";

export const kVersion = "__VERSION__";

export interface Page {
  engine: Engine;
  view(): Promise<View | undefined>;
}

export interface Run {
  program: string;
  args: string[];
  files: InputFile[];
  folders?: string[];
  /** Its peak, estimated. */
  memoryBytes: number | Promise<number>;
  /** Of the command: what stands for a file or folder that was dropped without its path. */
  shownArgs?: string[];
}

/** Options that the page has fields or choices for. */
const kFields = new Set(["iso", "max-error", "triangles", "smooth", "largest", "fill-cavities", "coordinates", "volume-index", "series",
  "list-series", "max-hole", "ball", "meg", "help", "brain-mask", "tissue", "preset", "layers", "vertices", "fif", "gifti", "labels",
  "names", "format", "file-names", "nested", "profile", "t1", "ct", "output"]);

/**
 * The advice for a program's message: how to give options that the page lacks, how to unpack files.
 * \param names  of files; words in them are no options
 */
function hintOf(text: string, names: string[]): string {
  const escaped = names.map((name) => name.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")).sort((a, b) => b.length - a.length);
  const line = escaped.reduce((rest, name) => rest.replace(new RegExp(`(?<![\\w-])${name}(?![\\w-])`, "g"), ""), text);
  const missing = [...new Set([...line.matchAll(/--([a-z][a-z0-9-]+)/g)].map(([, name]) => name))].filter((name) => !kFields.has(name));
  const program = /^adaptiso-(\w+):/.exec(line)?.[1];
  return [...(missing.length === 0 || program === undefined ? []
    : [`Not possible in this page: npx adaptiso ${program} ... ${missing.map((name) => `--${name}`).join(" ")}`]),
  ...(/\b(unzip|gunzip|tar) /.test(line) ? ["Unpack it first (Windows: right-click, Extract All), then give the folder."] : [])].join(" ");
}

/** A step of a run as programs name it, and how far it is: "extract 42 %". */
function parseProgress(text: string): { stage: string; percent: number | undefined } {
  const found = /^(.*?) (?:(\d+) %|\.\.\.)$/.exec(text);
  return { stage: found?.[1] ?? text, percent: found?.[2] === undefined ? undefined : Number(found[2]) };
}

/** The parts of a tab that a run fills: <section id="tab"> holds .go, .cancel, .progress, .refusal, .result. */
export class Task {
  private job: Job | undefined;
  private readonly section: HTMLElement;
  constructor(readonly id: string, readonly page: Page) {
    this.section = byId(id);
    this.part<HTMLButtonElement>(".cancel").addEventListener("click", () => this.cancel());
  }

  part<T extends HTMLElement = HTMLElement>(selector: string): T {
    const found = this.section.querySelector<T>(selector);
    if (found === null) throw new Error(`no ${selector} in #${this.id}`);
    return found;
  }

  private turn = 0;
  /** Ends the run, and takes its result away: its input is another one. */
  clear(): void {
    ++this.turn;
    this.cancel();
    this.part(".result").hidden = true;
  }

  get isRunning(): boolean { return this.job !== undefined; }
  cancel(): void { this.job?.cancel(); }

  /** \param choices  what can be pressed about it  \param names  of the files that it may name */
  refuse(line: string, choices: HTMLElement[] = [], names: string[] = []): void {
    const box = this.part(".refusal");
    box.textContent = line;
    box.hidden = line === "";
    const hint = hintOf(line, names);
    this.part(".choices").replaceChildren(...choices, ...(hint === "" || choices.length > 0 ? [] : [make("p", { className: "hint" }, hint)]));
  }

  /** \return nothing where it was cancelled or refused, which the tab then says */
  async run(run: Run): Promise<RunResult | undefined> {
    this.cancel();
    this.refuse("");
    const result = this.part(".result");
    result.hidden = true;
    result.replaceChildren();
    this.setRunning(true);
    const bar = this.part<HTMLProgressElement>("progress"), stage = this.part(".stage");
    stage.textContent = "start";
    bar.removeAttribute("value");
    const fits = Promise.resolve(run.memoryBytes).then((bytes) => {
      this.section.dataset.estimatedBytes = String(Math.round(bytes));
      if (bytes > kMostMemory) throw new Refused(tooLarge(run.files[0].path, bytes, run.program), 3);
    });
    const job = this.page.engine.run(run.program, [...run.args], run.files, run.folders ?? [], fits, (text) => {
      if (text === "") return;
      const step = parseProgress(text);
      stage.textContent = step.stage;
      if (step.percent === undefined) bar.removeAttribute("value"); else bar.value = step.percent;
    });
    this.job = job;
    try {
      const done = await job.result;
      this.section.dataset.memoryBytes = String(done.memoryBytes);
      const lines = done.stderr.split("\n").filter((line) => line !== "");
      const error = done.exitCode === 0 ? undefined : lines.at(-1);
      if (error !== undefined) {
        const names = run.files.map(({ path }) => path).filter((path) => path !== "");
        const moved = names.filter((path) => /^(names|mask)\//.test(path));  // into folders of the page
        this.refuse(moved.reduce((line, path) => line.replaceAll(path, path.slice(path.indexOf("/") + 1)), error), [],
          names.map((path) => path.split("/").at(-1) ?? path));
      }
      return done;
    } catch (error) {
      if (error instanceof Cancelled) this.refuse("Cancelled.");
      else this.refuse(error instanceof Refused ? error.line : String(error));
      return undefined;
    } finally {
      if (this.job === job) {
        this.job = undefined;
        this.setRunning(false);
      }
    }
  }

  private setRunning(isRunning: boolean): void {
    const go = this.part<HTMLButtonElement>(".go"), cancel = this.part<HTMLButtonElement>(".cancel");
    const [from, to] = isRunning ? [go, cancel] : [cancel, go], hasFocus = document.activeElement === from;
    const progress = this.part(".progress");
    progress.hidden = go.disabled = false;
    if (hasFocus) to.focus();  // a button that goes would take it along
    go.disabled = isRunning;
    progress.hidden = !isRunning;
    document.body.dataset.running = isRunning ? this.id : "";
  }

  /** The verdict, the command, and the files to save. */
  async show(title: string, run: Run, done: RunResult, files: OutputFile[], details: (Node | string)[] = []): Promise<void> {
    const command = [run.program, ...(run.shownArgs ?? run.args).map(quoted)].join(" ");
    const { turn } = this;
    const sums = await Promise.all(files.map((file) => sha256(file.bytes)));
    if (turn !== this.turn) return;
    const verdict = [title, `adaptiso ${kVersion}`,
      ...(files.length === 1 ? [`SHA-256 ${sums[0]}`] : [])].join("; ");
    const warnings = (reportOf(done)?.warnings ?? []) as ProgramWarning[];
    this.part(".result").replaceChildren(
      make("p", { className: "verdict" }, make("strong", {}, title)),
      ...details,
      ...(warnings.length > 0 ? [make("ul", { className: "warnings" }, ...warnings.map((warning) => make("li", {}, warningLine(warning))))] : []),
      copyLine("Verdict", verdict), copyLine("The same bytes by", command),
      make("p", { className: "cost" },
        `${done.seconds.toFixed(1)} s, ${formatBytes(done.memoryBytes)} of memory. Nothing was sent.`));
    this.part(".result").hidden = false;
    document.body.dataset.done = this.id;
    requestAnimationFrame(() => this.part(".result").scrollIntoView({ block: "nearest" }));
  }

  addGlb(name: string, surfaces: Surface[]): void {
    this.addSave("Save GLB", name, () => glb(surfaces, `adaptiso ${kVersion}`));
  }

  addSave(label: string, name: string, data: () => Blob | Uint8Array, isMain = false): void {
    const button = make("button", { type: "button", className: isMain ? "main" : "" }, label);
    button.addEventListener("click", () => save(name, data()));
    let row = this.part(".result").querySelector(":scope > .saves");
    if (row === null) {
      row = make("p", { className: "saves" });
      this.part(".result").querySelector(".verdict")?.after(row);
    }
    row.append(button);
  }
}

function copyLine(label: string, text: string): HTMLElement {
  const button = make("button", { type: "button" }, "Copy");
  button.setAttribute("aria-label", `Copy: ${label}`);
  button.addEventListener("click", () => copy(text, button));
  return make("div", { className: "copy" }, make("span", { className: "label" }, label), make("code", {}, text), button);
}

interface ProgramWarning { code: string; file: string | null; text: string }

const warningLine = ({ file, text }: ProgramWarning): string => (file === null ? text : `${file}: ${text}`);

/** The report that --json wrote. */
export function reportOf(done: RunResult): Record<string, unknown> | undefined {
  const file = done.files.find((each) => each.path === kReport);
  return file === undefined ? undefined : JSON.parse(new TextDecoder().decode(file.bytes));
}
export const kReport = "report.json";
export const outputsOf = (done: RunResult): OutputFile[] => done.files.filter((file) => file.path !== kReport);

/** Bytes: a page's memory ends at 4 GiB; the programs themselves begin with this much. */
export const kMostMemory = 4e9, kProgramBytes = 17e6;

export function tooLarge(what: string, bytes: number, program: string): string {
  return `${what} needs about ${formatBytes(bytes)} of memory, and a page has 4 GB: use ${program}`;
}

export function number(id: string): string { return byId<HTMLInputElement>(id).value.trim(); }
/** "100000" of "100,000" */
export function count(id: string): string { return number(id).replaceAll(",", ""); }
/** Names the files beyond those that a place takes. */
export function tellLeftOut(task: Task, files: InputFile[], most: number): void {
  if (files.length <= most) return;
  task.refuse(`${files.length} files: ${most === 1 ? "one is" : `${most} are`} taken here; left out: ${files.slice(most).map(({ path }) => path).join(", ")}`);
}

export const isNumber = (text: string): boolean => text !== "" && Number.isFinite(Number(text));
export function isChecked(id: string): boolean { return byId<HTMLInputElement>(id).checked; }
export { formatCount };
