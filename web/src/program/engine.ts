// The program in workers: it is compiled once. A job has a worker of its own, whose memory ends with it, or that of the job
// before, where what was found there may be used again.
import { bytesOf } from "./base85";
import type { Beginning, Help, Job, Ready, Word } from "./job";
import { compile, newMemory, type Engine } from "./memory";

declare const WORKER: string; // the script of the workers

let engine: Promise<Engine> | null = null;

async function unpack_engine(): Promise<Engine> {
  // The program stands at the end of the page, which may still be on its way from a slow disk.
  if (document.readyState === "loading") await new Promise((done) => document.addEventListener("DOMContentLoaded", done));
  const stream = new Blob([bytesOf(document.getElementById("engine")!.textContent!.trim())]).stream().pipeThrough(new DecompressionStream("gzip"));
  return compile(new Uint8Array(await new Response(stream).arrayBuffer()), self.crossOriginIsolated);
}

let script: string | null = null;

function startWorker(): Worker {
  script ??= URL.createObjectURL(new Blob([WORKER], { type: "text/javascript" }));
  return new Worker(script);
}

/** As many gates as a study often has. */
const most_threads = 8;

/** The worker that does a job, with those that help it where the browser lets them share its memory. They end together. */
class Team {
  private readonly first = startWorker();
  private readonly helpers: Worker[] = [];
  private engine: Engine | null = null;
  private memory?: WebAssembly.Memory;
  private stacks: number[] = [];
  private tell: ((word: Word) => void) | null = null;

  constructor() {
    this.listen(this.first);
  }

  private listen(worker: Worker): void {
    worker.onmessage = ({ data }: MessageEvent<Word | Ready>) => {
      if (data.kind === "ready") this.stacks = data.stacks;
      else this.tell?.(data);
      this.callHelpers();
    };
    worker.onerror = (event) => {
      event.preventDefault();
      this.tell?.({ kind: "lost", reason: event.message, memory: 0 });
    };
  }

  /** Gives it the program, once. */
  begin(engine: Engine): void {
    if (this.engine) return;
    this.engine = engine;
    try {
      if (engine.is_shared) this.memory = newMemory(engine);
    } catch {
      // The first worker asks for it again, and tells.
    }
    const stacks = engine.is_shared ? Math.min(navigator.hardwareConcurrency, most_threads) - 1 : 0;
    this.first.postMessage({ engine, memory: this.memory, stacks } satisfies Beginning);
  }

  /** A helper may come once the program has a stack for it, and is of use once there is a job. */
  private callHelpers(): void {
    if (!this.tell) return;
    for (const stack of this.stacks.splice(0)) {
      const helper = startWorker();
      this.helpers.push(helper);
      this.listen(helper);
      helper.postMessage({ engine: this.engine!, memory: this.memory!, stack } satisfies Help);
    }
  }

  /** The bytes of the job's files are given away. */
  run(job: Job, tell: (word: Word) => void): void {
    this.tell = tell;
    this.callHelpers();
    this.first.postMessage(job, job.files.map(({ bytes }) => bytes.buffer as ArrayBuffer));
  }

  terminate(): void {
    this.tell = null;
    for (const worker of [this.first, ...this.helpers]) worker.terminate();
  }
}

/** A program that holds more memory than this ends with its job. */
const most_kept = 300e6;

/**
 * Runs one job at a time: a new one ends the one before. With `ahead` the worker of the next job starts beside it. With
 * `keeps` the next job has the worker of the last one, and what the program kept there, until `forget`.
 */
export class Runner {
  private worker: Team | null = null;
  private kept: Team | null = null;
  private spare: Team | null = null;

  constructor(private readonly how: { ahead?: boolean; keeps?: boolean } = {}) {}

  /** The bytes of the job's files are given away. Throws where the program cannot be compiled; the next job tries again. */
  async run(job: Job, on_line: (word: Word & { kind: "line" }) => void = () => {}): Promise<Word> {
    engine ??= unpack_engine();
    this.stop();
    const mine = this.kept ?? this.spare ?? new Team();
    if (this.kept) this.kept = null;
    else this.spare = null;
    this.worker = mine;
    const compiled = await engine.catch((error: unknown) => {
      engine = null;
      throw error;
    });
    mine.begin(compiled);
    // Another job may have started one while the program was compiled.
    if (this.how.ahead && !this.spare) (this.spare = new Team()).begin(compiled);
    return new Promise((done) => {
      const end = (word: Word) => {
        const is_mine = this.worker === mine;
        if (is_mine) this.worker = null;
        const may_stay = word.kind === "end" && (word.code === 0 || word.code === 3) && word.memory < most_kept;
        if (is_mine && this.how.keeps && may_stay) this.kept = mine;
        else mine.terminate();
        done(word);
      };
      mine.run(job, (word) => {
        if (word.kind === "line") on_line(word);
        else end(word);
      });
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
