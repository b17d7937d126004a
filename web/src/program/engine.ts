// The program in workers: it is compiled once, and every job has a worker of its own, whose memory ends with it.
import { bytesOf } from "./base85";
import type { Job, Word } from "./job";

declare const WORKER: string; // the script of the worker

let engine: Promise<WebAssembly.Module> | null = null;

async function unpack_engine(): Promise<WebAssembly.Module> {
  // The program stands at the end of the page, which may still be on its way from a slow disk.
  if (document.readyState === "loading") await new Promise((done) => document.addEventListener("DOMContentLoaded", done));
  const stream = new Blob([bytesOf(document.getElementById("engine")!.textContent!.trim())]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

/** Runs one job at a time: a new one ends the one before. */
export class Runner {
  private worker: Worker | null = null;

  /** Throws where the program cannot be compiled; the next job tries again. */
  async run(job: Omit<Job, "engine">, on_line: (word: Word & { kind: "line" }) => void = () => {}): Promise<Word> {
    engine ??= unpack_engine();
    const url = URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
    const mine = new Worker(url);
    this.stop();
    this.worker = mine;
    const module = await engine.catch((error: unknown) => {
      engine = null;
      throw error;
    });
    return new Promise((done) => {
      const end = (word: Word) => {
        mine.terminate();
        URL.revokeObjectURL(url);
        if (this.worker === mine) this.worker = null;
        done(word);
      };
      mine.onmessage = (message: MessageEvent<Word>) => (message.data.kind === "line" ? on_line(message.data) : end(message.data));
      mine.onerror = (event) => {
        event.preventDefault();
        end({ kind: "lost", reason: event.message, memory: 0 });
      };
      mine.postMessage({ ...job, engine: module } satisfies Job);
    });
  }

  stop(): void {
    this.worker?.terminate();
    this.worker = null;
  }
}
