/** The page's side of the workers. */
import type { InputFile, Message, OpenedImage, OpenedMesh, OpenRequest, Reply, Request, RunResult, Series, Shape }
  from "./protocol";

/** The line that the program would print, and its exit code. */
export class Refused extends Error {
  constructor(readonly line: string, readonly exitCode: number, readonly series: Series[] = [],
    readonly volumes: number | null = null) { super(line); }
}
export class Cancelled extends Error {}

export interface Job { result: Promise<RunResult>; cancel(): void }

class Channel {
  private readonly worker: Worker;
  private next = 0;
  private readonly waiting = new Map<number, { resolve(value: unknown): void; reject(error: Error): void;
    onProgress?: (text: string) => void }>();

  constructor(url: string, private readonly module: WebAssembly.Module) {
    this.worker = new Worker(url);
    this.worker.addEventListener("message", (event: MessageEvent<Reply>) => this.take(event.data));
    this.worker.addEventListener("error", (event) => this.end(new Refused(`the page failed: ${event.message}`, 4)));
  }

  ask<T>(request: Request, onProgress?: (text: string) => void): Promise<T> {
    const id = this.next++;
    return new Promise<T>((resolve, reject) => {
      this.waiting.set(id, { resolve: resolve as (value: unknown) => void, reject, onProgress });
      const message: Message = { id, request, ...(id === 0 ? { module: this.module } : {}) };
      this.worker.postMessage(message);
    });
  }

  end(error: Error): void {
    this.worker.terminate();
    for (const { reject } of this.waiting.values()) reject(error);
    this.waiting.clear();
  }

  private take(reply: Reply): void {
    const one = this.waiting.get(reply.id);
    if (one === undefined) return;
    if (reply.kind === "progress") {
      one.onProgress?.(reply.text);
      return;
    }
    this.waiting.delete(reply.id);
    if (reply.kind === "done") one.resolve(reply.result);
    else one.reject(new Refused(reply.line, reply.exitCode, reply.series, reply.volumes));
  }
}

/** Looks at one image: its facts, slices and previews. The one before stays until another is open, then goes with its
 * memory. */
export class Looker {
  private channel: Channel | undefined;
  private opening: Channel | undefined;
  constructor(private readonly make: () => Promise<Channel>) {}

  /** \throws Cancelled  another was asked for meanwhile */
  async open(request: Omit<OpenRequest, "kind">): Promise<OpenedImage> {
    const channel = await this.make();
    this.opening?.end(new Cancelled());
    this.opening = channel;
    try {
      const opened = await channel.ask<OpenedImage>({ kind: "open", ...request });
      this.channel?.end(new Cancelled());
      this.channel = channel;
      return opened;
    } catch (error) {
      channel.end(new Cancelled());
      throw error;
    } finally {
      if (this.opening === channel) this.opening = undefined;
    }
  }
  async preview(isovalue: number): Promise<Shape> {
    if (this.channel === undefined) throw new Cancelled();
    return this.channel.ask<Shape>({ kind: "preview", isovalue });
  }
  async crossedEdges(isovalue: number): Promise<number> {
    if (this.channel === undefined) throw new Cancelled();
    return this.channel.ask<number>({ kind: "edges", isovalue });
  }
  async mesh(file: InputFile, program: string): Promise<OpenedMesh> {
    this.channel ??= await this.make();
    return this.channel.ask<OpenedMesh>({ kind: "mesh", file, program });
  }
}

export class Engine {
  constructor(private readonly url: Promise<string>, private readonly module: Promise<WebAssembly.Module>) {}

  looker(): Looker {
    return new Looker(() => this.channel());
  }

  /** Runs a program in an instance of its own once it `fits`; to cancel is to end its worker. */
  run(program: string, args: string[], files: InputFile[], folders: string[], fits: Promise<void>,
      onProgress: (text: string) => void): Job {
    let channel: Channel | undefined, isCancelled = false, stop = (): void => {};
    const cancelled = new Promise<never>((_, reject) => { stop = () => reject(new Cancelled()); });
    const start = async (): Promise<RunResult> => {
      await Promise.race([fits, cancelled]);
      channel = await this.channel();
      if (isCancelled) throw new Cancelled();
      try {
        return await channel.ask<RunResult>({ kind: "run", program, args, files, folders }, onProgress);
      } finally {
        channel.end(new Cancelled());
      }
    };
    return { result: start(), cancel: () => { isCancelled = true; stop(); channel?.end(new Cancelled()); } };
  }

  private async channel(): Promise<Channel> {
    const [url, module] = await Promise.all([this.url, this.module]);
    return new Channel(url, module);
  }
}
