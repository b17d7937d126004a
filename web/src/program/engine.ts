// The program in workers: it is compiled once. A job has a worker of its own, whose memory ends with it, or that of the job
// before, where what was found there may be used again.
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

let script: string | null = null;

function startWorker(): Worker {
  script ??= URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
  return new Worker(script);
}

/** A program that holds more memory than this ends with its job. */
const most_kept = 300e6;

/**
 * Runs one job at a time: a new one ends the one before. With `ahead` the worker of the next job starts beside it. With
 * `keeps` the next job has the worker of the last one, and what the program kept there, until `forget`.
 */
export class Runner {
  private worker: Worker | null = null;
  private kept: Worker | null = null;
  private spare: Worker | null = null;

  constructor(private readonly how: { ahead?: boolean; keeps?: boolean } = {}) {}

  /** The bytes of the job's files are given away. Throws where the program cannot be compiled; the next job tries again. */
  async run(job: Job, on_line: (word: Word & { kind: "line" }) => void = () => {}): Promise<Word> {
    engine ??= unpack_engine();
    this.stop();
    const has_program = this.kept ?? this.spare;
    const mine = has_program ?? startWorker();
    if (this.kept) this.kept = null;
    else this.spare = null;
    this.worker = mine;
    const module = await engine.catch((error: unknown) => {
      engine = null;
      throw error;
    });
    if (!has_program) mine.postMessage(module);
    // Another job may have started one while the program was compiled.
    if (this.how.ahead && !this.spare) (this.spare = startWorker()).postMessage(module);
    return new Promise((done) => {
      const end = (word: Word) => {
        const is_mine = this.worker === mine;
        if (is_mine) this.worker = null;
        const may_stay = word.kind === "end" && (word.code === 0 || word.code === 3) && word.memory < most_kept;
        if (is_mine && this.how.keeps && may_stay) this.kept = mine;
        else mine.terminate();
        done(word);
      };
      mine.onmessage = (message: MessageEvent<Word>) => (message.data.kind === "line" ? on_line(message.data) : end(message.data));
      mine.onerror = (event) => {
        event.preventDefault();
        end({ kind: "lost", reason: event.message, memory: 0 });
      };
      mine.postMessage(job, job.files.map(({ bytes }) => bytes.buffer as ArrayBuffer));
    });
  }

  stop(): void {
    this.worker?.terminate();
    this.worker = null;
  }

  /** Ends the worker that was kept, with all it knows. */
  forget(): void {
    this.kept?.terminate();
    this.kept = null;
  }
}

/** A browser compiles well what has run for a while: a small heart and a small scan are read before anybody asks, if nobody does. */
export async function warmUp(runner: Runner): Promise<void> {
  const phantom = (kind: string, settings: string[]) => ["phantom", kind, "--out", `/${kind}`, ...settings.flatMap((set) => ["--set", set])];
  const commands = [
    phantom("patient", ["gates=4", "lattice.nx=32", "lattice.ny=32", "lattice.nz=18", "lattice.dx_mm=4.5", "lattice.dy_mm=4.5", "lattice.dz_mm=6.5"]),
    ["ventricle", "/patient/study.dcm", "--out", "/heart"],
    phantom("cloud", ["shape=vase", "points=6000"]),
    ["cloud", "/cloud/cloud.ply", "--out", "/levels", "--triangles", "1280,320"],
  ];
  try {
    await runner.run({ files: [], commands, wanted: [] });
    runner.forget();
    document.documentElement.dataset.warm = "true";
  } catch {
    // Whoever asks for a run is told.
  }
}
