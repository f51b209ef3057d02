/** Adaptive, watertight isosurfaces and head models, by the programs of adaptiso as WebAssembly.
 *  Each call runs in a worker of its own: several may run at once, and none blocks the caller. */

import type { BemRows, CheckRows, LabelsRows, MendRows, MeshRows, SimplifyRows } from "./options.d.ts";

export type Samples = Uint8Array | Int8Array | Uint16Array | Int16Array | Uint32Array | Int32Array | Float32Array | Float64Array;

/** Samples, x fastest, and where they lie. */
export interface ImageArray {
  data: Samples;
  /** Voxels along i, j, k. */
  size: [number, number, number];
  /** Three rows of four, or four of four: voxel index to scanner RAS mm, as nibabel's `affine`. */
  affine: ArrayLike<number>;
}
/** A triangle mesh: points in scanner RAS mm, three numbers each; triangles counter-clockwise seen from outside. */
export interface MeshArray { points: Float64Array | Float32Array; triangles: Uint32Array }

/** A file: bytes with the name they go by; `path` is relative, of at most 1,000 characters, and may have folders (`model/head.surf`). Inputs of
 *  one name are kept apart, in folders `1`, `2`, ... that lines may then name. */
export interface NamedFile { path: string; bytes: Uint8Array }
export type ImageInput = ImageArray | NamedFile | File;
export type MeshInput = MeshArray | NamedFile | File;

export interface RunOptions {
  /** The stage of a run and how far it is: "extract 42 %". What it throws rejects the run. */
  onProgress?: (text: string) => void;
  /** Ends the run at once; its promise is rejected with the signal's reason. */
  signal?: AbortSignal;
  /** Further options, as the program's --help names them: ["--largest", "--smooth", "0.7"]. */
  args?: string[];
}

export interface RunResult {
  /** 0, or 1 where a check failed. */
  exitCode: 0 | 1;
  /** What --json writes; see the program's README. */
  report: Record<string, any>;
  /** The report's warnings, a line each: "t1.nii: ..."; their codes are in `report.warnings`. */
  warnings: string[];
  /** All files that the program wrote, but the report. */
  files: NamedFile[];
  memoryBytes: number;
}
export interface MeshResult extends RunResult { mesh: MeshArray }

/** A program refused, with the line it prints and its exit code: 2 usage, 3 bad input, 4 internal error. */
export class AdaptisoError extends Error { readonly exitCode: number }

export interface MeshOptions extends RunOptions, MeshRows {
  /** Isovalue; "auto" by Otsu's method (the default). */
  iso?: number | "auto";
}
/** adaptiso-mesh: the surface of an image. */
export function mesh(image: ImageInput, options?: MeshOptions): Promise<MeshResult>;

export interface SimplifyOptions extends RunOptions, SimplifyRows {}
/** adaptiso-simplify: fewer triangles within a stated distance. */
export function simplify(surface: MeshInput, options?: SimplifyOptions): Promise<MeshResult>;

export interface MendOptions extends RunOptions, MendRows {
  /** A closed surface in one piece: the result is moved outward where it must, to lie `gapMm` around it. */
  around?: MeshInput;
  gapMm?: number;
}
/** adaptiso-mend: a sound solid of any mesh. */
export function mend(surface: MeshInput, options?: MendOptions): Promise<MeshResult>;

/** adaptiso-check: soundness of surfaces. Faults are no exception: `exitCode` is 1 and `report` names them. */
export function check(surfaces: MeshInput | MeshInput[], options?: RunOptions & CheckRows): Promise<RunResult>;

/** adaptiso-compare: distances between two surfaces. */
export function compare(a: MeshInput, b: MeshInput, options?: RunOptions): Promise<RunResult>;

export interface LabelsOptions extends RunOptions, LabelsRows { format?: "stl" | "ply" | "obj" | "vtp" | "glb" | "3mf" }
/** adaptiso-labels: surfaces of all regions of a segmentation, as files. */
export function labels(image: ImageInput, options?: LabelsOptions): Promise<RunResult>;

export interface BemOptions extends RunOptions, BemRows { mask?: ImageInput; vertices?: number }
/** adaptiso-bem: a head model, as the files of its folder. */
export function bem(t1: ImageInput, options?: BemOptions): Promise<RunResult>;

/** Any of the programs with its own arguments, on files in memory, each at a relative path of its own. */
export function run(program: "mesh" | "simplify" | "mend" | "check" | "compare" | "labels" | "bem", args: string[],
  files: NamedFile[], options?: Omit<RunOptions, "args"> & { folders?: string[] }): Promise<{ exitCode: number; stdout: string;
  stderr: string; files: NamedFile[]; memoryBytes: number }>;
