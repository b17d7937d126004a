// The memory of the program. A page that the browser isolates from all others (it was served with the headers for it) may
// share memory between workers: the program then has threads. From a disk it has plain memory and one thread. Which of the
// two it takes is said by one byte of it.

const most_pages = 65536; // 4 GiB
const import_of_memory = [3, ...bytes("env"), 6, ...bytes("memory"), 2];

function bytes(word: string): number[] {
  return [...word].map((letter) => letter.charCodeAt(0));
}

/** A compiled program, the memory it needs at first, and whether its threads may share it. */
export interface Engine {
  module: WebAssembly.Module;
  pages: number;
  is_shared: boolean;
}

export async function compile(program: Uint8Array<ArrayBuffer>, is_shared: boolean): Promise<Engine> {
  const begin = program.findIndex((_, at) => import_of_memory.every((byte, n) => program[at + n] === byte));
  if (begin < 0) throw new Error("the program has a memory of its own");
  const end = begin + import_of_memory.length;
  program[end] = is_shared ? 3 : 1;
  let pages = 0;
  for (let at = end + 1, shift = 0; ; ++at, shift += 7) {
    pages |= (program[at]! & 127) << shift;
    if (program[at]! < 128) break;
  }
  return { module: await WebAssembly.compile(program), pages, is_shared };
}

/** Shared memory reserves all that it may ever take: a browser that has less is asked for less. */
export function newMemory({ pages, is_shared }: Engine): WebAssembly.Memory {
  for (let maximum = most_pages; ; maximum /= 2)
    try {
      return new WebAssembly.Memory({ initial: pages, maximum, shared: is_shared });
    } catch (error) {
      if (!is_shared || maximum / 2 < pages) throw error;
    }
}
