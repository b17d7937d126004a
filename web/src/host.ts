// What a report and the page around it say to each other.
import { toWorld, type Voxel } from "./cursor";
import { type Grid, toVoxels } from "./data";

/** The options `manual.*` that the report has handles or fields for. */
export const hand_keys = [
  "center_mm", "axis", "radius_mm", "first_slice", "last_slice", "base_shift_mm", "exclude_gates", "endo_points", "epi_points", "reader", "comment", "decision",
] as const;
/** Whether an option is said in the report as well. */
export const is_by_hand = (path: string): boolean => path.startsWith("manual.") && (hand_keys as readonly string[]).includes(path.slice("manual.".length));

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
export type Theme = "light" | "dark";
export type FromReport =
  | { dynasurf: "report"; word: "ready" }
  /** What is said, after every change; the gate that is looked at, from 1; whether every change is run at once. */
  | { dynasurf: "report"; word: "by hand"; said: ByHand; run: boolean; gate: number; at_once: boolean }
  /** Asks for a run with these options; the panel that it fills is looked at then. */
  | { dynasurf: "report"; word: "run with"; settings: [string, string][]; panel: string }
  | { dynasurf: "report"; word: "touched" }
  /** What its reader chose; null: it asks what was chosen before. */
  | { dynasurf: "report"; word: "theme"; theme: Theme | null }
  /** Where in the beat it is, from 0 to 1. */
  | { dynasurf: "report"; word: "beat"; share: number };
/** What `dynasurf borders --json` prints with what is said, and how long it took, or why it refused; null: nothing is changed. */
export type FoundBorders = { text: string; seconds: number } | { refusal: string };
export type FromPage =
  | { dynasurf: "page"; word: "beat"; share: number }
  /** Asks for the beat and for touches. */
  | { dynasurf: "page"; word: "share" }
  | { dynasurf: "page"; word: "theme"; theme: Theme }
  | { dynasurf: "page"; word: "borders"; found: FoundBorders | null }
  | ({ dynasurf: "page"; word: "study" } & Told);
/** What a report is told of its study. */
export interface Told {
  said: ByHand;
  /** The data of the report to compare with, null: none. */
  before: string | null;
  /** Every change by hand is run at once. */
  at_once: boolean;
  /** The run was asked for by hand: whoever asked looks on where he was. */
  correcting: boolean;
  /** The panel that the run was asked for; empty: none. */
  panel: string;
}

/** How a report tells what is said. */
export type Tell = (said: ByHand, run: boolean, gate: number, at_once: boolean) => void;

/** Whether both say the same. */
export function isSame(a: ByHand, b: ByHand): boolean {
  const paint = (a.paint ?? b.paint) === null || (a.paint !== null && b.paint !== null && a.paint.voxels.every((v, n) => v === b.paint!.voxels[n]));
  return paint && JSON.stringify(a.options) === JSON.stringify(b.options);
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

/** The paint of a file that `maskFile` wrote; null: it is another kind of file. */
export function paintOf(file: Uint8Array): Paint | null {
  const head = new TextDecoder("latin1").decode(file.subarray(0, 2000)).split("\n\n")[0]!;
  const line = (name: string) => new RegExp(`^${name}: (.*)$`, "m").exec(head)?.[1] ?? "";
  const numbers = (text: string) => (text.match(/[-+.\de]+/g) ?? []).map(Number);
  const dims = numbers(line("sizes"));
  const axes = numbers(line("space directions"));
  const origin_mm = numbers(line("space origin"));
  const count = dims.reduce((a, b) => a * b, 1);
  const is_mine = head.startsWith("NRRD") && line("type") === "uint8" && line("encoding") === "raw" && line("space") === "left-posterior-superior";
  if (!is_mine || dims.length !== 3 || axes.length !== 9 || origin_mm.length !== 3 || file.length !== head.length + 2 + count) return null;
  const spacing_mm = [0, 1, 2].map((axis) => Math.hypot(...axes.slice(3 * axis, 3 * axis + 3)));
  const direction = [0, 1, 2].flatMap((row) => [0, 1, 2].map((axis) => axes[3 * axis + row]! / spacing_mm[axis]!));
  const voxels = Uint8Array.from(file.subarray(head.length + 2), (looked_at) => (looked_at ? 0 : 1));
  return { grid: { dims, spacing_mm, origin_mm, direction } as Grid, voxels };
}

/** One word of a command line. */
export const quoted = (word: string): string => (/^[\w.=,:+/-]+$/.test(word) ? word : `'${word.replaceAll("'", "'\\''")}'`);

/** The arguments of `dynasurf ventricle` that repeat what was said. */
export const argumentsOf = ({ options, paint }: ByHand): string[] => [
  ...Object.entries(options).flatMap(([path, value]) => ["--set", `${path}=${value}`]),
  ...(paint ? ["--mask", mask_name] : []),
];

/** Paint on another grid: each voxel as the nearest one of the paint. */
export function onGrid({ grid, voxels }: Paint, to: Grid): Uint8Array {
  if (JSON.stringify(grid) === JSON.stringify(to)) return voxels.slice();
  const out = new Uint8Array(to.dims[0] * to.dims[1] * to.dims[2]);
  const place = new Float32Array(3);
  let n = 0;
  for (let k = 0; k < to.dims[2]; ++k)
    for (let j = 0; j < to.dims[1]; ++j)
      for (let i = 0; i < to.dims[0]; ++i, ++n) {
        place.set(toWorld(to, [i, j, k]));
        const [x, y, z] = [...toVoxels(grid, place)].map(Math.round) as Voxel;
        const inside = x >= 0 && y >= 0 && z >= 0 && x < grid.dims[0] && y < grid.dims[1] && z < grid.dims[2];
        out[n] = inside ? voxels[x + grid.dims[0] * (y + grid.dims[1] * z)]! : 0;
      }
  return out;
}
