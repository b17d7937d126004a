// A thread of the program: a WASI command over files in memory, or one that helps it. It can ask for nothing but them, the
// time and random numbers.
import { ConsoleStdout, PreopenDirectory, WASI, wasi as system } from "@bjorn3/browser_wasi_shim";
import { files_in, nothing, tree_of } from "./files_in_memory";
import type { Beginning, Help, Job, Ready, Word } from "./job";
import { newMemory } from "./memory";

const say = (word: Word | Ready, moved: Transferable[] = []) => self.postMessage(word, { transfer: moved });

/** What the program says to the page, line by line, as to a file that is no terminal: it then tells its progress in lines. */
function to_page(held: () => number): ConsoleStdout {
  const file = ConsoleStdout.lineBuffered((text: string) => say({ kind: "line", text, memory: held() }));
  file.fd_fdstat_get = () => ({ ret: 0, fdstat: new system.Fdstat(system.FILETYPE_UNKNOWN, 0) });
  return file;
}

/** The program: started once, then called for one command after the other. It keeps what the stages of a run found. */
interface Program {
  wasi: WASI;
  memory: WebAssembly.Memory;
  main: () => number;
  new_stack: (bytes: number) => number;
}
let beginning: Beginning;
let program: Program | null = null;

/** The stack of a helper, and above it what a thread has for itself. */
const stack_bytes = 1 << 20;
const own_bytes = 1 << 12;

function instance_of(module: WebAssembly.Module, wasi: WASI, memory: WebAssembly.Memory): WebAssembly.Exports {
  return new WebAssembly.Instance(module, { wasi_snapshot_preview1: wasi.wasiImport, env: { memory } }).exports;
}

function start(): Program {
  const { engine } = beginning;
  const memory = beginning.memory ?? newMemory(engine);
  const wasi = new WASI([], [], [], { debug: false });
  wasi.fds = [nothing(), nothing(), nothing(), new PreopenDirectory("/", new Map())]; // it looks once which folders there are
  const { _initialize, __main_void, new_stack } = instance_of(engine.module, wasi, memory);
  wasi.initialize({ exports: { memory, _initialize: _initialize as () => unknown } });
  return { wasi, memory, main: __main_void as () => number, new_stack: new_stack as (bytes: number) => number };
}

/** What takes time before the first job can start. */
function begin(): void {
  try {
    program = start();
    const stacks = Array.from({ length: beginning.stacks ?? 0 }, () => program!.new_stack(stack_bytes + own_bytes));
    say({ kind: "ready", stacks: stacks.filter((at) => at !== 0) });
  } catch {
    // Without the memory for it, the job will tell.
  }
}

function run(job: Job): void {
  const started = performance.now();
  const root = tree_of(job.files);
  const held = () => program?.memory.buffer.byteLength ?? 0;
  let output = "";
  let code = 0;
  for (const command of job.commands) {
    output = "";
    const decoder = new TextDecoder();
    const to_output = new ConsoleStdout((bytes: Uint8Array) => void (output += decoder.decode(bytes, { stream: true })));
    program ??= start();
    const { wasi, main } = program;
    wasi.args = ["dynasurf", ...command];
    wasi.fds = [nothing(), to_output, to_page(held), new PreopenDirectory("/", root)];
    try {
      code = main();
    } catch (error) {
      const memory = held();
      program = null;
      return say({ kind: "lost", reason: String(error), memory });
    }
    if (code === 1 || code === 2) break;
  }
  const files = files_in(root, "").filter(({ path }) => job.wanted.some((folder) => path.startsWith(`${folder}/`)));
  const seconds = (performance.now() - started) / 1000;
  say({ kind: "end", code, output, files, memory: held(), seconds }, files.map(({ bytes }) => bytes.buffer as ArrayBuffer));
}

/** Takes pieces of the program's loops, for ever. */
function help({ engine, memory, stack }: Help): void {
  const wasi = new WASI([], [], [nothing(), nothing(), to_page(() => memory.buffer.byteLength)], { debug: false });
  const thread = instance_of(engine.module, wasi, memory);
  wasi.initialize({ exports: { memory } });
  if ((thread.__tls_size as WebAssembly.Global).value > own_bytes) throw new Error("a thread has more for itself than there is room");
  (thread.__stack_pointer as WebAssembly.Global).value = stack + stack_bytes;
  (thread.__wasm_init_tls as (at: number) => void)(stack + stack_bytes);
  (thread.help as () => void)();
}

self.onmessage = ({ data }: MessageEvent<Beginning | Help | Job>) => {
  if ("commands" in data) run(data);
  else if ("stack" in data) help(data);
  else {
    beginning = data;
    begin();
  }
};
