// Everything that is text and numbers: verdict, cards, tables, provenance.
import { isCorrected, walls, type GateNumbers, type Interval, type NoteText, type Reading, type Results, type WallName } from "./data";
import { figure, html } from "./dom";
import { byHandWords, decisionWords, manualOf } from "./said";
import { say, told } from "./words";

export const verdicts = {
  ok: { title: say("Checks passed"), text: say("No quality flag was raised. Still compare the contours with the images before you use a number.") },
  check: { title: say("Check this result"), text: say("Look at what is flagged here before you use a number.") },
  fail: { title: say("Failed: do not use these numbers"), text: say("The study could not be reconstructed in a way that can be trusted. Why:") },
} as const;

const wall_names: Record<WallName, string> = { endo: say("Endo"), epi: say("Epi") };

function icon(name: "ok" | "check" | "fail" | "info"): HTMLElement {
  const sign = { ok: "✓", check: "!", fail: "✕", info: "i" }[name];
  return html("span", { class: `icon ${name}`, "aria-hidden": "true" }, sign);
}

const icon_of = { info: "info", warning: "check", failure: "fail" } as const;
export const word_of = { info: say("Info"), warning: say("Warning"), failure: say("Failure") } as const;

const counted = {
  failure: (n: number) => (n === 1 ? say("1 failure") : say("{n} failures", { n })),
  warning: (n: number) => (n === 1 ? say("1 warning") : say("{n} warnings", { n })),
  info: (n: number) => (n === 1 ? say("1 remark") : say("{n} remarks", { n })),
} as const;

/** A line that says what is not the program's own finding. */
export function byHandLine(results: Results): HTMLElement[] {
  const words = byHandWords(results);
  const decision = decisionWords(results);
  return [
    ...(decision ? [html("p", { class: `decision ${String(manualOf(results)?.decision)}` }, decision)] : []),
    ...(words.length > 0 ? [html("p", { class: "by-hand" }, html("b", {}, `${say("Changed by hand:")} `), words.join(", "))] : []),
  ];
}

export function showVerdict(place: HTMLElement, results: Results): void {
  const { verdict, flags } = results.quality;
  const { title, text } = verdicts[verdict];
  place.classList.add(verdict);
  const list = flags.map((flag) =>
    html("li", { class: flag.severity }, html("b", {}, word_of[flag.severity]), " ", told(flag.message), html("code", {}, flag.code)),
  );
  const parts = (["failure", "warning", "info"] as const).flatMap((severity) => {
    const count = results.notes.filter((note) => note.severity === severity).length;
    return count === 0 ? [] : [counted[severity](count)];
  });
  place.replaceChildren(
    icon(verdict),
    html("div", {}, html("h1", {}, title), html("p", {}, text), ...byHandLine(results), ...(list.length ? [html("ul", {}, ...list)] : [])),
    ...(parts.length ? [html("a", { href: "#notes-title", class: "to-notes" }, `${say("Notes")}: ${parts.join(", ")}`)] : []),
  );
}

interface Card {
  name: string;
  value: string;
  unit: string;
  detail: string;
  strong?: boolean;
}

function cardsOf(results: Results): Card[] {
  if (results.study.gates === 1) {
    const only = results.gates[0];
    return [
      { name: say("Ejection fraction"), value: "–", unit: "", detail: say("not gated: no beat to measure"), strong: true },
      { name: say("Cavity"), value: figure(only?.endo_ml), unit: "mL", detail: say("endocardial surface") },
      { name: say("Outer volume"), value: figure(only?.epi_ml), unit: "mL", detail: say("epicardial surface") },
      { name: say("Wall"), value: figure(only?.wall_ml), unit: "mL", detail: say("between the surfaces") },
    ];
  }
  const gate = (number: number | null) => (number === null ? "" : say("gate {gate}", { gate: number }));
  const range = (interval: Interval, other: string) =>
    interval ? say("90 %: {low} to {high}", { low: figure(interval[0]), high: figure(interval[1]) }) : other;
  const variation = results.quality.wall_variation;
  return [
    { name: say("Ejection fraction"), value: figure(results.ef_percent), unit: "%", detail: range(results.ef_percent_90, say("stroke / end-diastolic volume")), strong: true },
    { name: say("End-diastolic volume"), value: figure(results.edv_ml), unit: "mL", detail: range(results.edv_ml_90, gate(results.ed_gate)) },
    { name: say("End-systolic volume"), value: figure(results.esv_ml), unit: "mL", detail: range(results.esv_ml_90, gate(results.es_gate)) },
    { name: say("Stroke volume"), value: figure(results.sv_ml), unit: "mL", detail: range(results.sv_ml_90, say("end-diastolic − end-systolic")) },
    ...(isBloodPool(results)
      ? []
      : [
          {
            name: say("Wall, mean"),
            value: figure(results.wall_ml),
            unit: "mL",
            detail: range(results.wall_ml_90, variation === null ? "" : say("varies by {n} %", { n: figure(100 * variation, 0) })),
          },
        ]),
  ];
}

/** An image of the blood: the cavity is measured, and nothing of a wall. */
export const isBloodPool = ({ measures }: Results): boolean => measures !== null && measures.thickness_is === null;

/** What is measured beyond the volumes of the gates. */
function measuresOf(results: Results): Card[] {
  const measures = results.measures;
  const fit = measures?.function;
  if (!measures || !fit) return [];
  const rate = fit.peak_filling_edv_per_s;
  const phase = measures.phase.counts ?? measures.phase.motion;
  const time = fit.time_to_peak_filling_ms;
  return [
    {
      name: say("EF of the fit"),
      value: figure(fit.ef_percent),
      unit: "%",
      detail: say("{edv} / {esv} mL; gates as instants {ef} %", { edv: figure(fit.edv_ml, 0), esv: figure(fit.esv_ml, 0), ef: figure(fit.instants.ef_percent) }),
    },
    {
      name: say("Peak filling rate"),
      value: figure(rate ?? fit.peak_filling_edv_per_beat, 2),
      unit: rate === null ? say("EDV/beat") : say("EDV/s"),
      detail: say("{time} after ES; first third {n} %", {
        time: time === null ? say("{n} beat", { n: figure(fit.time_to_peak_filling, 2) }) : `${figure(time, 0)} ms`,
        n: figure(100 * (fit.first_third_filling ?? 0), 0),
      }),
    },
    ...(isBloodPool(results)
      ? []
      : [
          {
            name: measures.thickness_is === "apparent" ? say("Muscle, apparent") : say("Muscle"),
            value: figure(measures.muscle_g, 0),
            unit: "g",
            detail: say("{n} mL at 1.05 g/mL", { n: figure(measures.muscle_ml, 0) }),
          },
        ]),
    ...(phase
      ? [
          {
            name: measures.phase.counts ? say("Phase SD") : say("Phase SD, motion"),
            value: figure(phase.sd_deg),
            unit: "°",
            detail: say("bandwidth {deg}°, entropy {n} %", { deg: figure(phase.bandwidth_deg, 0), n: figure(phase.entropy_percent, 0) }),
          },
        ]
      : []),
  ];
}

export function showCards(place: HTMLElement, results: Results): void {
  const failed = results.quality.verdict === "fail";
  place.classList.toggle("untrusted", failed);
  place.replaceChildren(
    ...[...cardsOf(results), ...measuresOf(results)].map((card) =>
      html(
        "div",
        { class: card.strong ? "card strong" : "card" },
        html("h2", {}, card.name),
        html("p", { class: "value" }, card.value, card.value === "–" ? "" : html("small", {}, card.unit)),
        html("p", { class: "detail" }, failed ? (card.value === "–" ? say("not available") : say("not to be trusted")) : card.detail),
      ),
    ),
  );
}

export function subjectOf(results: Results): string {
  const { study } = results;
  const kind = [study.format, study.modality, study.image_type].filter(Boolean).join(" ");
  const gates = study.gates > 1 ? say("{n} gates", { n: study.gates }) : say("not gated");
  const size = study.dims ? study.dims.join(" × ") : "";
  const spacing = study.spacing_mm ? `${study.spacing_mm.map((s) => figure(s)).join(" × ")} mm` : "";
  return [kind, gates, size, spacing].filter(Boolean).join(" · ");
}

const reading_numbers = ["edv_ml", "esv_ml", "sv_ml", "ef_percent", "wall_ml"] as const;

/** The same study read in three ways, side by side, the leading one first; with 90 % intervals where they are known. */
export function showReadings(place: HTMLElement, results: Results): void {
  const { psf_corrected, edge, gaussian_profile } = results.readings;
  const cell = (reading: Reading, key: (typeof reading_numbers)[number]) => {
    const interval = reading[`${key}_90`];
    return interval ? `${figure(reading[key])} (${figure(interval[0])}–${figure(interval[1])})` : figure(reading[key]);
  };
  const row = (name: string, what: string, reading: Reading | null, leads = false) =>
    reading
      ? [html("tr", { class: leads ? "leads" : null }, html("th", { scope: "row" }, name, html("small", {}, what)), ...reading_numbers.map((key) => html("td", {}, cell(reading, key))))]
      : [];
  const heads = [say("Reading"), "EDV mL", "ESV mL", "SV mL", "EF %", say("Wall mL")];
  place.replaceChildren(
    html(
      "table",
      { class: "numbers readings" },
      html("thead", {}, html("tr", {}, ...heads.map((head) => html("th", { scope: "col" }, head)))),
      html(
        "tbody",
        {},
        ...row(say("PSF-corrected"), say("surfaces of all gates fitted through the point spread; in brackets 90 % intervals"), psf_corrected, true),
        ...row(say("Edge"), say("where the image is steepest: blur makes its volumes small"), edge, !isCorrected(results)),
        ...row(
          say("Gaussian profile"),
          say("65 % of the deviations of an asymmetric Gaussian, constant muscle (QGS-style): the ejection fraction is too high"),
          gaussian_profile,
        ),
      ),
    ),
  );
}

const percent = (value: number | null | undefined) => (value === null || value === undefined ? "–" : figure(100 * value));

function gateRow(gate: GateNumbers, results: Results): HTMLTableRowElement {
  const both = (cell: (wall: WallName) => string) => walls.map((wall) => html("td", {}, cell(wall)));
  const marks = [gate.gate === results.readings.edge.ed_gate ? "ED" : "", gate.gate === results.readings.edge.es_gate ? "ES" : ""].filter(Boolean);
  return html(
    "tr",
    { "data-gate": gate.gate },
    html("th", { scope: "row" }, String(gate.gate), ...marks.map((m) => html("span", { class: "tag" }, m))),
    html("td", {}, figure(gate.time_ms, 0)),
    html("td", { class: "endo" }, figure(gate.edge.endo_ml)),
    html("td", { class: "epi" }, figure(gate.edge.epi_ml)),
    html("td", {}, figure(gate.edge.wall_ml)),
    ...both((wall) => percent(gate.edge[wall]?.stopped_fraction)),
    ...both((wall) => percent(gate.edge[wall]?.within_one_voxel)),
    ...both((wall) => figure(gate.edge[wall]?.mean_distance_mm, 2)),
    ...both((wall) => figure(gate.edge[wall]?.triangles.shape_min, 2)),
    ...both((wall) => told((gate.edge[wall]?.stop_reason ?? "–").replaceAll("_", " "))),
  );
}

/** Returns a function that marks the gate shown. */
export function showGates(place: HTMLElement, results: Results): (gate: number) => void {
  const group = (name: string, title: string) => html("th", { colspan: 2, scope: "colgroup", title }, name);
  const names = Array.from({ length: 5 }, () => walls.map((wall) => html("th", { scope: "col", class: wall }, wall_names[wall]))).flat();
  const rows = results.gates.map((gate) => gateRow(gate, results));
  place.replaceChildren(
    html(
      "table",
      { class: "numbers" },
      html(
        "thead",
        {},
        html(
          "tr",
          {},
          html("th", { rowspan: 2, scope: "col" }, say("Gate")),
          html("th", { rowspan: 2, scope: "col" }, say("Time"), html("small", {}, "ms")),
          html("th", { rowspan: 2, scope: "col", class: "endo" }, say("Cavity"), html("small", {}, "mL")),
          html("th", { rowspan: 2, scope: "col", class: "epi" }, say("Outer"), html("small", {}, "mL")),
          html("th", { rowspan: 2, scope: "col" }, say("Wall"), html("small", {}, "mL")),
          group(say("On the border, %"), say("Particles of the surface that reached their border")),
          group(say("Within a voxel, %"), say("Particles closer than one voxel to a border voxel")),
          group(say("Distance, mm"), say("Mean distance of the particles to the nearest border voxel")),
          group(say("Worst triangle"), say("Shape of the worst triangle: 1 equilateral, 0 degenerate")),
          group(say("Ended because"), say("Why the motion of the surface ended")),
        ),
        html("tr", {}, ...names),
      ),
      html("tbody", {}, ...rows),
    ),
  );
  return (gate) => rows.forEach((row, g) => row.toggleAttribute("aria-current", g === gate));
}

const order = { failure: 0, warning: 1, info: 2 } as const;

/** "1–3, 5" in the words for one and for several. */
function rangesOf(numbers: number[], one: (of: string) => string, several: (of: string) => string): string {
  const sorted = [...new Set(numbers)].sort((a, b) => a - b);
  const ranges: string[] = [];
  for (let n = 0; n < sorted.length; ) {
    let last = n;
    while (sorted[last + 1] === sorted[last]! + 1) ++last;
    ranges.push(last > n ? `${sorted[n]}–${sorted[last]}` : String(sorted[n]));
    n = last + 1;
  }
  return ranges.length === 0 ? "" : (sorted.length > 1 ? several : one)(ranges.join(", "));
}

const gatesOf = (numbers: number[]) => rangesOf(numbers, (gate) => say("gate {gate}", { gate }), (gates) => say("gates {gates}", { gates }));
const slicesOf = (numbers: number[]) =>
  rangesOf(numbers, (slice) => say("slice {slice}", { slice }), (slices) => say("slices {slices}", { slices }));

/** Places of a note: gates alone as ranges, else each gate with its slice. */
function placesOf(notes: NoteText[]): string[] {
  if (notes.every((note) => !note.slice)) return [gatesOf(notes.flatMap((n) => n.gate ?? []))].filter(Boolean);
  const gates = new Map<number, number[]>();
  for (const { gate, slice } of notes) gates.set(gate ?? 0, [...(gates.get(gate ?? 0) ?? []), ...(slice ? [slice] : [])]);
  return [...gates].map(([gate, slices]) => [gate ? gatesOf([gate]) : "", slicesOf(slices)].filter(Boolean).join(", "));
}

/** Notes that differ only in gate and slice become one line. */
export function showNotes(place: HTMLElement, notes: NoteText[]): void {
  if (notes.length === 0) {
    place.replaceChildren(html("p", { class: "empty" }, say("The program had nothing to remark.")));
    return;
  }
  const lines = new Map<string, NoteText[]>();
  for (const note of notes) {
    const key = `${note.severity} ${note.code} ${note.message}`;
    lines.set(key, [...(lines.get(key) ?? []), note]);
  }
  const sorted = [...lines.values()].sort((a, b) => order[a[0]!.severity] - order[b[0]!.severity]);
  place.replaceChildren(
    html(
      "ul",
      { class: "notes" },
      ...sorted.map((same) => {
        const { severity, code, message } = same[0]!;
        return html(
          "li",
          { class: severity },
          icon(icon_of[severity]),
          html(
            "div",
            {},
            html("span", { class: "visually-hidden" }, `${word_of[severity]}: `),
            told(message),
            html("small", {}, [code, ...placesOf(same)].join(" · ")),
          ),
        );
      }),
    ),
  );
}

function pairs(rows: [string, string | Node][]): HTMLElement {
  return html("dl", {}, ...rows.flatMap(([name, value]) => [html("dt", {}, name), html("dd", {}, value)]));
}

export function showProvenance(place: HTMLElement, results: Pick<Results, "provenance" | "timings_s" | "schema">): void {
  const { provenance, timings_s } = results;
  const rows: [string, string | Node][] = [
    [say("Program"), `${provenance.program} ${provenance.version}`],
    [say("Commit"), html("code", {}, provenance.commit || "–")],
    [say("Command"), html("code", {}, provenance.command || "–")],
  ];
  if (provenance.seed !== null) rows.push([say("Seed"), String(provenance.seed)]);
  rows.push([say("Schema"), results.schema]);
  const inputs = provenance.inputs.map(({ file, sha256 }) =>
    html("li", {}, file, html("code", { title: "SHA-256" }, sha256)),
  );
  const files = html(
    "details",
    { open: inputs.length <= 4 },
    html("summary", {}, inputs.length === 1 ? say("Input: 1 file with SHA-256") : say("Input: {n} files with SHA-256", { n: inputs.length })),
    html("ul", { class: "files" }, ...inputs),
  );
  const timings = Object.entries(timings_s ?? {});
  const total = timings.reduce((sum, [, seconds]) => sum + seconds, 0);
  const times = timings.length
    ? html(
        "table",
        { class: "timings" },
        html("caption", {}, say("Time per stage")),
        ...timings.map(([stage, seconds]) =>
          html(
            "tr",
            {},
            html("th", { scope: "row" }, told(stage)),
            html("td", {}, `${figure(seconds, 3)} s`),
            html("td", { class: "bar" }, html("meter", { min: 0, max: total || 1, value: seconds, "aria-hidden": "true" })),
          ),
        ),
      )
    : html("p", { class: "empty" }, say("Times per stage were not recorded, so that a repeated run gives the same file."));
  place.replaceChildren(pairs(rows), files, times);
}

function leaves(value: unknown, path: string): [string, string][] {
  if (value !== null && typeof value === "object" && !Array.isArray(value))
    return Object.entries(value).flatMap(([name, part]) => leaves(part, path ? `${path}.${name}` : name));
  return [[path, value === null ? say("automatic") : Array.isArray(value) ? JSON.stringify(value) : String(value)]];
}

export function showOptions(place: HTMLElement, results: Pick<Results, "provenance">): void {
  const rows = results.provenance.options === null ? [] : leaves(results.provenance.options, "");
  if (rows.length === 0) {
    place.replaceChildren(html("p", { class: "empty" }, say("Parameters were not recorded.")));
    return;
  }
  place.replaceChildren(
    html(
      "table",
      { class: "options" },
      html("tbody", {}, ...rows.map(([path, value]) => html("tr", {}, html("th", { scope: "row" }, path), html("td", {}, value)))),
    ),
  );
}
