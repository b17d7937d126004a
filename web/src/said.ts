// What a person can say in place of what was found: the options `manual.*` of the program that the report has handles
// for.
import type { Voxel } from "./cursor";
import type { Results } from "./data";

export interface Said {
  center_mm?: Voxel;
  axis?: Voxel;
  radius_mm?: number;
  first_slice?: number;
  last_slice?: number;
  base_shift_mm?: number;
  exclude_gates?: number[];
  endo_points?: number[];
  epi_points?: number[];
  decision?: "accepted" | "rejected";
  reader?: string;
  comment?: string;
}
export type Key = keyof Said;
export const fields: { key: Key; name: string; title: string; is_text?: boolean }[] = [
  { key: "center_mm", name: "Centre x,y,z mm", title: "Middle of the heart in the world: left, posterior, superior" },
  { key: "axis", name: "Axis x,y,z", title: "Long axis from apex to base" },
  { key: "radius_mm", name: "Circle mm", title: "Radius of the circle outside which nothing is looked at" },
  { key: "first_slice", name: "First slice", title: "First slice of the ventricle, from 1 at the apex" },
  { key: "last_slice", name: "Last slice", title: "Last slice of the ventricle" },
  { key: "base_shift_mm", name: "Valve plane moved mm", title: "Away from the apex, in every gate" },
  { key: "exclude_gates", name: "Excluded gates", title: "Such as 3,4: the means of their neighbours stand in their place" },
  { key: "endo_points", name: "Inner border", title: "Points that the inner wall goes through: gate,x,y,z of each, mm in the world" },
  { key: "epi_points", name: "Outer border", title: "Points that the outer wall goes through: gate,x,y,z of each, mm in the world" },
  { key: "reader", name: "Reader", title: "Who accepts or rejects the result", is_text: true },
  { key: "comment", name: "Comment", title: "Why, in your words", is_text: true },
];
const all_keys: Key[] = [...fields.map(({ key }) => key), "decision"];

export const rounded = (v: number) => Math.round(v * 100) / 100;
export const roundedOf = (key: Key) => (v: number) => (key === "axis" ? Math.round(v * 1e4) / 1e4 : rounded(v));

type Manual = Record<string, unknown> | undefined;

/** The options that a result was made with. */
export const manualOf = ({ provenance }: Pick<Results, "provenance">): Manual =>
  (provenance.options as { manual?: Record<string, unknown> } | null)?.manual;

/** A value as the program's options have it; what is not set is absent. */
export function saidIn(manual: Manual): Said {
  const said: Record<string, unknown> = {};
  for (const key of all_keys) {
    const value = manual?.[key];
    const is_nothing = value === null || value === undefined || value === "" || value === "none";
    if (!is_nothing && !(Array.isArray(value) && value.length === 0)) said[key] = value;
  }
  return said as Said;
}

function pointWords(numbers: number[] | undefined, wall: string): string {
  const count = (numbers?.length ?? 0) / 4;
  return `${count} point${count === 1 ? "" : "s"} of the ${wall} border`;
}

/** What a result says that a person said, in words; empty: nothing. */
export function byHandWords(results: Results): string[] {
  const manual = manualOf(results);
  const said = saidIn(manual);
  const names: Record<Exclude<Key, "decision" | "reader" | "comment">, string> = {
    center_mm: "centre",
    axis: "long axis",
    radius_mm: `circle of ${said.radius_mm} mm`,
    first_slice: `first slice ${said.first_slice}`,
    last_slice: `last slice ${said.last_slice}`,
    base_shift_mm: `valve plane moved by ${said.base_shift_mm} mm`,
    endo_points: pointWords(said.endo_points, "inner"),
    epi_points: pointWords(said.epi_points, "outer"),
    exclude_gates: `without gate${said.exclude_gates?.length === 1 ? "" : "s"} ${said.exclude_gates?.join(", ")}`,
  };
  const words = fields.flatMap(({ key }) => (key in names && said[key] !== undefined ? [names[key as keyof typeof names]] : []));
  const base = manual?.base_plane_mm ?? null;
  if (base !== null) words.push(`valve plane at ${String(base)} mm`);
  if (results.notes.some(({ code }) => code === "region.used")) words.push("mask");
  return words;
}

/** What a reader decided: "Accepted by A. Reader: well seen"; null: nothing. */
export function decisionWords(results: Results): string | null {
  const { decision, reader, comment } = saidIn(manualOf(results));
  if (!decision && !reader && !comment) return null;
  const word = decision === "accepted" ? "Accepted" : decision === "rejected" ? "Rejected" : "Looked at";
  return `${word}${reader ? ` by ${reader}` : ""}${comment ? `: ${comment}` : ""}`;
}
