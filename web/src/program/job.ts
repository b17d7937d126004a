// What the page and its worker say to each other. The page begins with the program (WebAssembly.Module).

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
