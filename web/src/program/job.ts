// What the page and its workers say to each other.
import type { Engine } from "./memory";

/** The page begins with the program. Where its memory is shared, the page has made it, and asks for stacks for helpers. */
export interface Beginning {
  engine: Engine;
  memory?: WebAssembly.Memory;
  stacks?: number;
}

/** Another worker takes pieces of the program's loops, on one of these stacks. */
export interface Help {
  engine: Engine;
  memory: WebAssembly.Memory;
  stack: number;
}

/** A worker has begun, and has stacks for helpers. */
export interface Ready {
  kind: "ready";
  stacks: number[];
}

/** A file in memory: its path from the root, with slashes and without a leading one. */
export interface Piece {
  path: string;
  bytes: Uint8Array;
}

/** Copies, to be given away: the files stay here for another run. */
export const copyOf = (files: Piece[]): Piece[] => files.map(({ path, bytes }) => ({ path, bytes: bytes.slice() }));

/** Commands of the program, run one after the other over the same files until one fails. */
export interface Job {
  files: Piece[];
  commands: string[][];
  /** The folders whose files come back. */
  wanted: string[];
}

export type Word =
  | { kind: "line"; text: string; memory: number }
  | { kind: "end"; code: number; output: string; files: Piece[]; memory: number; seconds: number }
  | { kind: "lost"; reason: string; memory: number };
