/** What the page and its workers say to each other. */

/** A file of a job, at its path in the job's folder. */
export interface InputFile { path: string; data: Blob | Uint8Array }
export interface OutputFile { path: string; bytes: Uint8Array }

export interface RunRequest {
  kind: "run";
  program: string;
  args: string[];
  files: InputFile[];
  /** Folders are made first; every file that is new afterwards is an output. */
  folders: string[];
}

/** Options of reading an image, by the programs' names. */
export type ReadOptions = Readonly<Record<string, number | string>>;

export interface OpenRequest {
  kind: "open";
  files: InputFile[];
  path: string;
  read: ReadOptions;
  isLabels: boolean;
}
export interface PreviewRequest { kind: "preview"; isovalue: number }
/** Counts the pairs of neighbouring voxels of the open image that a surface passes between; with NaN, those that differ. */
export interface EdgesRequest { kind: "edges"; isovalue: number }
export interface MeshRequest { kind: "mesh"; file: InputFile; program: string }

export type Request = RunRequest | OpenRequest | PreviewRequest | EdgesRequest | MeshRequest;
export interface Message { id: number; module?: WebAssembly.Module; request: Request }

export interface RunResult {
  exitCode: number;
  stderr: string;
  files: OutputFile[];
  memoryBytes: number;
  seconds: number;
}

/** adaptisoOpenImage()'s answer (Web.cxx). */
export interface ImageFacts {
  format: string;
  geometry: { sizeVoxels: number[]; spacingMm: number[]; originMm: number[] };
  defaultErrorMm: number;
  orientation: string;
  type: string;
  bytes: number;
  minimum: number;
  maximum: number;
  isInteger: boolean;
  otsu: number | null;
  histogram: { lower: number; upper: number; counts: number[] } | null;
  warnings: string[];
  shownSize: number[];
  shownAffine: number[];
  previewStep: number;
  /** Of a label map, ascending: the n-th is shade n + 1, two bytes each. Empty: it has none, or too many to colour. */
  labels: number[];
  labelColors: [number, number, number][];
}
/** adaptisoListSeries()'s answer. */
export interface Series {
  number: number; modality: string; description: string; size: number[]; volumes: number; spacingMm: number[];
  orientation: string; localizer: boolean; details: [string, string][]; fault: string;
}
/** Scanner RAS mm; normals of any length. */
export interface Shape { points: Float32Array; triangles: Uint32Array; normals: Float32Array; values: Float32Array | null }
export interface OpenedImage { facts: ImageFacts; shades: Uint8Array }
export interface OpenedMesh { shape: Shape; format: string; frame: string | null; valuesName: string | null }

export type Reply =
  | { id: number; kind: "progress"; text: string }
  | { id: number; kind: "done"; result: RunResult | OpenedImage | OpenedMesh | Shape | number }
  /** \param volumes, series  to choose from, where a choice is needed */
  | { id: number; kind: "refused"; line: string; exitCode: number; volumes: number | null; series: Series[] };
