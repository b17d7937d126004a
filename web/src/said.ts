// What a person can say in place of what was found: the options `manual.*` of the program that the report has handles
// for.
import type { Voxel } from "./cursor";
import type { Results } from "./data";
import { hand_keys } from "./host";
import { say } from "./words";

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
export type Key = (typeof hand_keys)[number];
export const fields: { key: Key; name: string; title: string; is_text?: boolean }[] = [
  { key: "center_mm", name: say("Centre x,y,z mm"), title: say("Middle of the heart in the world: left, posterior, superior") },
  { key: "axis", name: say("Axis x,y,z"), title: say("Long axis from apex to base") },
  { key: "radius_mm", name: say("Circle mm"), title: say("Radius of the circle outside which nothing is looked at") },
  { key: "first_slice", name: say("First slice"), title: say("First slice of the ventricle, from 1 at the apex") },
  { key: "last_slice", name: say("Last slice"), title: say("Last slice of the ventricle") },
  { key: "base_shift_mm", name: say("Valve plane moved mm"), title: say("Away from the apex, in every gate") },
  { key: "exclude_gates", name: say("Excluded gates"), title: say("Such as 3,4: the means of their neighbours stand in their place") },
  { key: "endo_points", name: say("Inner border"), title: say("Points that the inner wall goes through: gate,x,y,z of each, mm in the world") },
  { key: "epi_points", name: say("Outer border"), title: say("Points that the outer wall goes through: gate,x,y,z of each, mm in the world") },
  { key: "reader", name: say("Reader"), title: say("Who accepts or rejects the result"), is_text: true },
  { key: "comment", name: say("Comment"), title: say("Why, in your words"), is_text: true },
];
const all_keys: Key[] = hand_keys.slice();

export const rounded = (v: number) => Math.round(v * 100) / 100;
export const roundedOf = (key: Key) => (v: number) => (key === "axis" ? Math.round(v * 1e4) / 1e4 : rounded(v));

/** A value as one types it, or as an option of the program has it; undefined: none. Throws RangeError with what was expected. */
export function valueOf(key: Key, text: string): Said[Key] | undefined {
  const words = text.trim();
  if (key === "reader" || key === "comment") return (words || undefined) as never;
  if (words === "" || words === "unset" || words === "none") return undefined;
  if (key === "decision") return words as never;
  const numbers = words.split(/[ ,;]+/).filter(Boolean).map(Number);
  const are_points = key.endsWith("_points");
  const is_place = key === "center_mm" || key === "axis";
  const is_list = are_points || key === "exclude_gates";
  const fits = is_place ? numbers.length === 3 : are_points ? numbers.length % 4 === 0 : is_list || numbers.length === 1;
  if (!fits || !numbers.every(Number.isFinite))
    throw new RangeError(is_place ? say("expected three numbers") : are_points ? say("expected four numbers for each point") : say("expected a number"));
  return (is_list || is_place ? numbers : numbers[0]) as never;
}

/** What options of the program say by hand; what they cannot mean is left to the program, which will refuse it. */
export function saidFrom(options: Record<string, string>): Said {
  const said: Record<string, unknown> = {};
  for (const key of all_keys)
    try {
      const value = valueOf(key, options[`manual.${key}`] ?? "");
      if (value !== undefined) said[key] = value;
    } catch (error) {
      if (!(error instanceof RangeError)) throw error;
    }
  return said as Said;
}

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

/** What a result says that a person said, in words; empty: nothing. */
export function byHandWords(results: Results): string[] {
  const manual = manualOf(results);
  const said = saidIn(manual);
  const gates = said.exclude_gates?.join(", ") ?? "";
  const [of_inner, of_outer] = [said.endo_points, said.epi_points].map((numbers) => (numbers?.length ?? 0) / 4) as [number, number];
  const names: Record<Exclude<Key, "decision" | "reader" | "comment">, string> = {
    center_mm: say("centre"),
    axis: say("long axis"),
    radius_mm: say("circle of {mm} mm", { mm: said.radius_mm! }),
    first_slice: say("first slice {slice}", { slice: said.first_slice! }),
    last_slice: say("last slice {slice}", { slice: said.last_slice! }),
    base_shift_mm: say("valve plane moved by {mm} mm", { mm: said.base_shift_mm! }),
    endo_points: of_inner === 1 ? say("1 point of the inner border") : say("{n} points of the inner border", { n: of_inner }),
    epi_points: of_outer === 1 ? say("1 point of the outer border") : say("{n} points of the outer border", { n: of_outer }),
    exclude_gates: said.exclude_gates?.length === 1 ? say("without gate {gate}", { gate: gates }) : say("without gates {gates}", { gates }),
  };
  const words = fields.flatMap(({ key }) => (key in names && said[key] !== undefined ? [names[key as keyof typeof names]] : []));
  const base = manual?.base_plane_mm ?? null;
  if (base !== null) words.push(say("valve plane at {mm} mm", { mm: String(base) }));
  if (results.notes.some(({ code }) => code === "region.used")) words.push(say("mask"));
  return words;
}

/** What a reader decided: "Accepted by A. Reader: well seen"; null: nothing. */
export function decisionWords(results: Results): string | null {
  const { decision, reader, comment } = saidIn(manualOf(results));
  if (!decision && !reader && !comment) return null;
  const word = decision === "accepted" ? say("Accepted") : decision === "rejected" ? say("Rejected") : say("Looked at");
  return `${word}${reader ? ` ${say("by {reader}", { reader })}` : ""}${comment ? `: ${comment}` : ""}`;
}
