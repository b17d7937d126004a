// What a report and the page around it say to each other.
import type { Grid } from "./data";

/** 1: a voxel of `grid` that a person painted out. */
export interface Paint {
  grid: Grid;
  voxels: Uint8Array;
}
/** What a person says in place of what was found: options of the program by their path, and paint. */
export interface ByHand {
  options: Record<string, string>;
  paint: Paint | null;
}
export type FromReport =
  | { dynasurf: "report"; word: "ready" }
  | { dynasurf: "report"; word: "by hand"; said: ByHand; run: boolean };
export interface FromPage {
  dynasurf: "page";
  said: ByHand;
  /** The data of the report to compare with, null: none. */
  before: string | null;
  /** The run was asked for by hand: whoever asked looks on where he was. */
  correcting: boolean;
}

export const nothing_said = (): ByHand => ({ options: {}, paint: null });
export const mask_name = "mask.nrrd";

/** Paint as the file for `--mask`, which is 1 where the study is looked at. */
export function maskFile({ grid, voxels }: Paint): Uint8Array {
  const { dims, spacing_mm, origin_mm, direction } = grid;
  const vector = (v: number[]) => `(${v.join(",")})`;
  const axes = [0, 1, 2].map((axis) => vector([0, 1, 2].map((row) => direction[3 * row + axis]! * spacing_mm[axis]!)));
  const head = new TextEncoder().encode(
    [
      "NRRD0004",
      "type: uint8",
      "dimension: 3",
      "space: left-posterior-superior",
      `sizes: ${dims.join(" ")}`,
      `space directions: ${axes.join(" ")}`,
      "encoding: raw",
      `space origin: ${vector(origin_mm)}`,
      "\n",
    ].join("\n"),
  );
  const file = new Uint8Array(head.length + voxels.length);
  file.set(head);
  voxels.forEach((painted, n) => (file[head.length + n] = painted ? 0 : 1));
  return file;
}

/** One word of a command line. */
export const quoted = (word: string): string => (/^[\w.=,:+/-]+$/.test(word) ? word : `'${word}'`);

/** The arguments of `dynasurf ventricle` that repeat what was said. */
export const argumentsOf = ({ options, paint }: ByHand): string[] => [
  ...Object.entries(options).flatMap(([path, value]) => ["--set", `${path}=${value}`]),
  ...(paint ? ["--mask", mask_name] : []),
];
