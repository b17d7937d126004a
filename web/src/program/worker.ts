// The program: a WASI command over files in memory. It can ask for nothing but them, the time and random numbers.
import { ConsoleStdout, Directory, File, type Inode, OpenFile, PreopenDirectory, WASI, wasi as system } from "@bjorn3/browser_wasi_shim";
import type { Job, Piece, Word } from "./job";

const say = (word: Word, moved: Transferable[] = []) => self.postMessage(word, { transfer: moved });

// A file that has a name has a link; the library tells none, and the program takes such a file for removed.
for (const kind of [File, Directory]) {
  const plain = kind.prototype.stat;
  kind.prototype.stat = function (this: File & Directory) {
    const facts = plain.call(this);
    facts.nlink = 1n;
    return facts;
  };
}

// The library copies a file for every write that makes it longer; room that doubles makes a long file linear in time.
const rooms = new WeakMap<File, ArrayBufferLike>();
const write_in_place = OpenFile.prototype.fd_write;
OpenFile.prototype.fd_write = function (this: OpenFile, bytes: Uint8Array) {
  const { file } = this;
  const length = Number(this.file_pos) + bytes.byteLength;
  if (!file.readonly && length > file.data.byteLength) {
    let room = rooms.get(file);
    if (room !== file.data.buffer || length > room.byteLength) {
      const wider = new Uint8Array(Math.max(length, 2 * file.data.byteLength, 4096));
      wider.set(file.data);
      rooms.set(file, (room = wider.buffer));
    }
    file.data = new Uint8Array(room as ArrayBuffer, 0, length);
  }
  return write_in_place.call(this, bytes);
};

function tree_of(files: Piece[]): Map<string, Inode> {
  const root = new Map<string, Inode>([["tmp", new Directory(new Map())]]);
  for (const { path, bytes } of files) {
    const parts = path.split("/");
    const name = parts.pop()!;
    let folder = root;
    for (const part of parts) {
      let inner = folder.get(part);
      if (!(inner instanceof Directory)) folder.set(part, (inner = new Directory(new Map())));
      folder = (inner as Directory).contents;
    }
    const file = new File([]);
    file.data = bytes; // not copied
    folder.set(name, file);
  }
  return root;
}

function files_in(folder: Map<string, Inode>, at: string, found: Piece[] = []): Piece[] {
  for (const [name, entry] of folder)
    if (entry instanceof Directory) files_in(entry.contents, `${at}${name}/`, found);
    else if (entry instanceof File) found.push({ path: at + name, bytes: rooms.has(entry) ? entry.data.slice() : entry.data });
  return found;
}

/** The program: started once, then called for one command after the other. It keeps what the stages of a run found. */
interface Program {
  wasi: WASI;
  memory: WebAssembly.Memory;
  main: () => number;
}
let engine: WebAssembly.Module;
let program: Program | null = null;

function start(): Program {
  const wasi = new WASI([], [], [], { debug: false });
  wasi.fds = [nothing(), nothing(), nothing(), new PreopenDirectory("/", new Map())]; // it looks once which folders there are
  const instance = new WebAssembly.Instance(engine, { wasi_snapshot_preview1: wasi.wasiImport });
  const { memory, _initialize, __main_void } = instance.exports;
  wasi.initialize({ exports: { memory: memory as WebAssembly.Memory, _initialize: _initialize as () => unknown } });
  return { wasi, memory: memory as WebAssembly.Memory, main: __main_void as () => number };
}

const nothing = () => new OpenFile(new File([]));

/** What takes time before the first job can start. */
function prepare(module: WebAssembly.Module): void {
  engine = module;
  try {
    program = start();
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
    const to_page = ConsoleStdout.lineBuffered((text: string) => say({ kind: "line", text, memory: held() }));
    // No terminal: the program then tells its progress in lines.
    to_page.fd_fdstat_get = () => ({ ret: 0, fdstat: new system.Fdstat(system.FILETYPE_UNKNOWN, 0) });
    program ??= start();
    const { wasi, main } = program;
    wasi.args = ["dynasurf", ...command];
    wasi.fds = [nothing(), to_output, to_page, new PreopenDirectory("/", root)];
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

self.onmessage = ({ data }: MessageEvent<WebAssembly.Module | Job>) => (data instanceof WebAssembly.Module ? prepare(data) : run(data));
