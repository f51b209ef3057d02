/** The histogram of an image's values with the isovalue on it. Heights are square roots: air would hide the rest. */
import type { ImageFacts } from "./protocol";

export class Histogram {
  private facts: ImageFacts | undefined;
  private isovalue = 0;

  constructor(private readonly canvas: HTMLCanvasElement, private readonly pick: (isovalue: number) => void) {
    const move = (event: PointerEvent): void => {
      if (event.buttons !== 1 || !this.facts?.histogram) return;
      const { lower, upper } = this.facts.histogram, box = canvas.getBoundingClientRect();
      const part = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      this.pick(lower + part * (upper - lower));
    };
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); move(event); });
    canvas.addEventListener("pointermove", move);
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.draw());
  }

  show(facts: ImageFacts): void { this.facts = facts; this.draw(); }
  mark(isovalue: number): void { this.isovalue = isovalue; this.draw(); }

  private draw(): void {
    const { canvas } = this, context = canvas.getContext("2d");
    const scale = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * scale);
    canvas.height = Math.round(canvas.clientHeight * scale);
    if (context === null || !this.facts?.histogram) return;
    const style = getComputedStyle(canvas), { lower, upper, counts } = this.facts.histogram;
    const bars = Math.min(counts.length, 200), heights = new Array<number>(bars).fill(0);
    counts.forEach((count, n) => { heights[Math.floor(n * bars / counts.length)] += count; });
    const roots = heights.map(Math.sqrt), [, most] = [1, ...roots].sort((a, b) => b - a);  // the highest, often air, may be cut
    const x = Math.min(1, Math.max(0, (this.isovalue - lower) / (upper - lower))) * canvas.width;
    for (let n = 0; n < bars; ++n) {
      const left = n * canvas.width / bars, height = Math.min(1, roots[n] / most) * (canvas.height - 4 * scale);
      context.fillStyle = style.getPropertyValue(left >= x ? "--accent" : "--faint");
      context.fillRect(left, canvas.height - height, Math.max(1, canvas.width / bars - 0.5), height);
    }
    context.fillStyle = style.getPropertyValue("--ink");
    context.fillRect(x - scale, 0, 2 * scale, canvas.height);
  }
}
