/**
 * Slices and 3-D by niivue, to which this adds the surfaces (painter.ts), their outlines on the slices, and the
 * keys. Points are scanner RAS mm throughout.
 */
import type { Niivue } from "@niivue/niivue";
import { swatch } from "./dom";
import { type Color, type Outline, type Painted, Painter, type Surface } from "./painter";
import type { Shape } from "./protocol";
import { boundsOf } from "./shape";

interface Drawn extends Painted { cuts: { at: number; outline: Outline }[] }
interface Plane { normal: number[]; at: number }
interface Tile { axCorSag: number; leftTopWidthHeight: number[]; leftTopMM: number[]; fovMM: number[] }

/** Of a tile: the axis it is cut across, and those that run across and up it. */
const kAxes: Record<number, [number, number, number]> = { 0: [2, 0, 1], 1: [1, 0, 2], 2: [0, 1, 2] };

/** Where a mesh meets a plane: pairs of points, flat. */
function cutOf({ points, triangles }: Shape, { normal, at }: Plane): Float32Array<ArrayBuffer> {
  const heights = new Float32Array(points.length / 3), found: number[] = [];
  for (let n = 0; n < heights.length; ++n) {
    heights[n] = normal[0] * points[3 * n] + normal[1] * points[3 * n + 1] + normal[2] * points[3 * n + 2];
  }
  for (let t = 0; t < triangles.length; t += 3) {
    for (let side = 0; side < 3; ++side) {
      const from = triangles[t + side], to = triangles[t + (side + 1) % 3];
      if ((heights[from] >= at) === (heights[to] >= at)) continue;
      const part = (at - heights[from]) / (heights[to] - heights[from]);
      for (let k = 0; k < 3; ++k) found.push(points[3 * from + k] + part * (points[3 * to + k] - points[3 * from + k]));
    }
  }
  return Float32Array.from(found);
}

/** Nothing where no label is. */
function labelColormap(colors: Color[]): never {
  const channel = (at: number): number[] => [0, ...colors.map((color) => color[at])];
  return { R: channel(0), G: channel(1), B: channel(2), A: [0, ...colors.map(() => 255)],
    I: [0, ...colors.map((_, n) => n + 1)], labels: [] } as never;
}

export class View {
  private readonly nv: Niivue;
  private readonly painter: Painter;
  private drawn: Drawn[] = [];
  private turn = Promise.resolve();

  private constructor(private readonly library: typeof import("@niivue/niivue"), private readonly canvas: HTMLCanvasElement,
      private readonly position: HTMLElement, private readonly caption: HTMLElement, nv: Niivue) {
    this.nv = nv;
    this.painter = new Painter(nv.gl);
    this.hook();
    canvas.addEventListener("keydown", (event) => this.step(event), true);
  }

  /** \throws Error where there is no WebGL 2 */
  static async make(library: typeof import("@niivue/niivue"), canvas: HTMLCanvasElement,
      position: HTMLElement, caption: HTMLElement): Promise<View> {
    const probe = document.createElement("canvas").getContext("webgl2");
    if (probe === null) {
      throw new Error("Slices and 3-D need WebGL 2, which this browser does not have or has turned off. Meshes are made all the same.");
    }
    const nv = new library.Niivue({ logLevel: "error", dragAndDropEnabled: false, isSliceMM: true, meshThicknessOn2D: 0,
      multiplanarShowRender: library.SHOW_RENDER.ALWAYS, multiplanarLayout: library.MULTIPLANAR_TYPE.GRID,
      multiplanarPadPixels: 4, isOrientCube: false, isCornerOrientationText: true, show3Dcrosshair: true, crosshairWidth: 0.35,
      crosshairWidthUnit: "percent", crosshairColor: [1, 0.28, 0.28, 0.8], crosshairGap: 3, backColor: [0, 0, 0, 1],
      fontColor: [0.75, 0.78, 0.82, 1], dragMode: library.DRAG_MODE.pan });
    const isSoftware = /swiftshader|llvmpipe|software/i.test(String(probe.getParameter(
      probe.getExtension("WEBGL_debug_renderer_info")?.UNMASKED_RENDERER_WEBGL ?? probe.RENDERER)));
    await nv.attachToCanvas(canvas, !isSoftware);  // smooth edges take a processor four times as long
    const view = new View(library, canvas, position, caption, nv);
    nv.setSliceType(library.SLICE_TYPE.MULTIPLANAR);
    nv.setRenderAzimuthElevation(145, 12);
    return view;
  }

  /** One change at a time, in the order asked for. */
  private next(work: () => Promise<void>): Promise<void> {
    const done = this.turn.then(work);
    this.turn = done.catch(() => {});
    return done;
  }

  /** \param labelColors  of a label map: of its n-th label; empty: an image */
  showImage(file: Uint8Array<ArrayBuffer>, labelColors: Color[]): Promise<void> {
    return this.next(async () => {
      this.clearMeshes();
      for (const volume of [...this.nv.volumes]) this.nv.removeVolume(volume);
      const blob = new File([file], "image.nii");
      const volume = await this.library.NVImage.loadFromFile({ file: blob, name: "image.nii",
        colormap: "gray", cal_min: 0, cal_max: 255 } as never);
      if (labelColors.length > 0) volume.setColormapLabel(labelColormap(labelColors));
      this.nv.setInterpolation(labelColors.length > 0);  // nearest: no label lies between two others
      this.nv.addVolume(volume);
      this.moveTo([0, 1, 2].map((axis) => (this.nv.frac2mm([0.5, 0.5, 0.5] as never) as unknown as number[])[axis]));
    });
  }

  showSurfaces(surfaces: Surface[]): Promise<void> {
    return this.next(async () => {
      if (this.nv.volumes.length === 0) await this.showBlank(surfaces);
      this.clearMeshes();
      this.drawn = surfaces.map((surface) => ({ ...this.painter.add(surface), cuts: [] }));
      this.caption.replaceChildren(...surfaces.length > 5 ? [] : surfaces.flatMap(({ name, color, colors }) => [
        ...(colors ? [] : [swatch(color)]), `${name} `]));
      this.nv.drawScene();
    });
  }

  /** Of the label map that is shown: the colour of its n-th label. */
  setLabelColors(colors: Color[]): Promise<void> {
    return this.next(async () => {
      this.nv.volumes[0]?.setColormapLabel(labelColormap(colors));
      this.nv.updateGLVolume();
    });
  }

  setShown(index: number, isShown: boolean): void {
    const one = this.drawn[index];
    if (one === undefined) return;
    one.isShown = isShown;
    this.nv.drawScene();
  }

  show3dAlone(isAlone: boolean): void {
    this.nv.setSliceType(isAlone ? this.library.SLICE_TYPE.RENDER : this.library.SLICE_TYPE.MULTIPLANAR);
  }

  moveTo(point: number[]): void {
    this.nv.scene.crosshairPos = this.nv.mm2frac(point as never);
    this.nv.drawScene();
  }

  clear(): Promise<void> {
    return this.next(async () => {
      this.clearMeshes();
      for (const volume of [...this.nv.volumes]) this.nv.removeVolume(volume);
      this.nv.drawScene();
    });
  }

  private clearMeshes(): void {
    for (const one of this.drawn) {
      this.painter.remove(one);
      for (const cut of one.cuts) if (cut) this.painter.removeOutline(cut.outline);
    }
    this.drawn = [];
    this.caption.replaceChildren();
  }

  /** A black image around meshes that have none. */
  private async showBlank(surfaces: Surface[]): Promise<void> {
    const { low, high } = boundsOf(surfaces.map(({ shape }) => shape));
    if (!low.every(Number.isFinite)) return;
    const kSize = 24, { nifti } = await import("./nifti");
    const steps = low.map((value, axis) => Math.max(1e-3, (high[axis] - value) * 1.2 / (kSize - 1)));
    const first = low.map((value, axis) => (value + high[axis]) / 2 - steps[axis] * (kSize - 1) / 2);
    const file = nifti([kSize, kSize, kSize], [steps[0], 0, 0, first[0], 0, steps[1], 0, first[1], 0, 0, steps[2], first[2]],
      new Uint8Array(kSize ** 3));
    this.nv.addVolume(await this.library.NVImage.loadFromFile({ file: new File([file], "blank.nii"), name: "blank.nii",
      colormap: "gray", cal_min: 0, cal_max: 255 } as never));
  }

  private hook(): void {
    const nv = this.nv as unknown as Record<string, unknown> & { gl: WebGL2RenderingContext };
    const drawScene = (nv.drawScene as (...given: unknown[]) => unknown).bind(nv);
    nv.drawMesh3D = (_isDepthTest: boolean, _alpha: number, toScreen: Float32Array, _model: unknown, turn: Float32Array, is2D = false) => {
      if (!is2D) this.painter.draw(this.drawn, toScreen, turn, this.nv.uiData.mouseDepthPicker);
    };
    nv.drawImage3D = () => {};
    nv.drawScene = (...given: unknown[]) => {
      const result = drawScene(...given);
      this.drawOutlines();
      const text = this.nv.volumes.length === 0 ? "" : this.crosshair().map((v) => v.toFixed(1)).join(", ");
      this.position.textContent = text === "" ? "" : `${text} mm (RAS)`;
      return result;
    };
  }

  private crosshair(): number[] {
    return Array.from(this.nv.frac2mm(this.nv.scene.crosshairPos) as unknown as number[]).slice(0, 3);
  }

  /** The plane of voxels that a tile shows: oblique where the image is. */
  private planeOf(axis: number): Plane {
    const share = (point: number[]): number => (this.nv.mm2frac(point as never) as unknown as number[])[axis];
    const zero = share([0, 0, 0]);
    return { normal: [[100, 0, 0], [0, 100, 0], [0, 0, 100]].map((end) => (share(end) - zero) / 100),
      at: (this.nv.scene.crosshairPos as unknown as number[])[axis] - zero };
  }

  private drawOutlines(): void {
    const { canvas } = this, pixel = canvas.width / Math.max(1, canvas.clientWidth);
    if (this.nv.volumes.length === 0) return;
    for (const tile of (this.nv as unknown as { screenSlices: Tile[] }).screenSlices) {
      if (!(tile.axCorSag in kAxes) || !(tile.fovMM?.length > 1)) continue;
      const [left, top, width, height] = tile.leftTopWidthHeight, [axis, ...axes] = kAxes[tile.axCorSag];
      const plane = this.planeOf(axis), bottom = canvas.height - top - height;
      const outlines = this.drawn.filter((one) => one.isShown).map((one) => {
        if (one.cuts[axis]?.at !== plane.at) {
          if (one.cuts[axis]) this.painter.removeOutline(one.cuts[axis].outline);
          one.cuts[axis] = { at: plane.at, outline: this.painter.addOutline(cutOf(one.surface.shape, plane)) };
        }
        return { outline: one.cuts[axis].outline, color: one.surface.color };
      });
      const scale = [width / tile.fovMM[0], height / tile.fovMM[1]];
      this.painter.drawOutlines(outlines, { box: [left, bottom, width, height], axes,
        toPixel: [...scale, left - scale[0] * tile.leftTopMM[0], bottom - scale[1] * tile.leftTopMM[1]] }, pixel);
    }
  }

  private step(event: KeyboardEvent): void {
    const steps: Record<string, number[]> = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0],
      ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };
    const step = steps[event.key];
    if (step === undefined || this.nv.volumes.length === 0) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    const far = event.shiftKey ? 10 : 1;
    this.moveTo(this.crosshair().map((value, axis) => value + far * step[axis]));
  }
}
