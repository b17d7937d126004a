// Two A4 pages of a result, for printing: what a reader of a report looks for, and nothing that moves.
import { Curve } from "./curve";
import type { Wall } from "./cycle";
import { isCorrected, type PhaseNumbers, type Report, type Results } from "./data";
import { figure, html, svg } from "./dom";
import type { Painter } from "./painter";
import { Player } from "./player";
import { drawPolar, segmentTable, titleOfMap } from "./polar";
import type { SurfaceScene } from "./scene";
import { Splash } from "./splash";
import { byHandLine, showCards, showReadings, subjectOf, verdicts, word_of } from "./tables";
import { say, told } from "./words";

interface Parts {
  report: Report;
  painter: Painter | null;
  walls: Wall[];
  scene: SurfaceScene | null;
  moments: { name: string; gate: number }[];
}

/** Maps that a reader looks for first; more would not fit. */
const printed_maps = ["perfusion_percent", "thickening_percent", "count_thickening_percent", "motion_mm", "phase_counts_deg", "thickness_ed_mm"];
const most_flags = 6;
const most_inputs = 2;

function head({ results }: Report, page: number): HTMLElement {
  return html(
    "header",
    {},
    html("div", {}, html("strong", {}, say("Dynasurf: left ventricle")), html("span", {}, subjectOf(results))),
    html("p", {}, say("Research use only. Not for diagnosis."), html("span", {}, say("page {n} of 2", { n: page }))),
  );
}

function verdictOf({ results }: Report): HTMLElement {
  const { verdict, flags } = results.quality;
  const more = flags.length - most_flags;
  return html(
    "section",
    { class: `paper-verdict ${verdict}` },
    html("p", {}, html("b", {}, `${verdicts[verdict].title}. `), verdicts[verdict].text),
    ...byHandLine(results),
    html(
      "ul",
      {},
      ...flags.slice(0, most_flags).map((flag) => html("li", {}, html("b", {}, `${word_of[flag.severity]}: `), told(flag.message))),
      ...(more > 0 ? [html("li", {}, say("and {n} more in results.json", { n: more }))] : []),
    ),
  );
}

/** Numbers of the beat that the cards do not hold. */
function beatOf({ results }: Report): HTMLElement {
  const fit = results.measures?.function;
  const rows: [string, string][] = [];
  if (fit) {
    const rate = (per_s: number | null) => (per_s === null ? "–" : `${figure(per_s, 2)} EDV/s`);
    rows.push(
      [say("Periodic fit, {n} waves", { n: fit.waves }), `EDV ${figure(fit.edv_ml)}, ESV ${figure(fit.esv_ml)} mL, EF ${figure(fit.ef_percent)} %`],
      [say("Had the gates been instants"), `EF ${figure(fit.instants.ef_percent)} %`],
      [say("Peak emptying, filling rate"), `${rate(fit.peak_emptying_edv_per_s)}, ${rate(fit.peak_filling_edv_per_s)}`],
      [say("Time to peak filling"), fit.time_to_peak_filling_ms === null ? "–" : say("{n} ms after end systole", { n: figure(fit.time_to_peak_filling_ms, 0) })],
      [say("Back after a third of diastole"), say("{n} % of the stroke volume", { n: figure(100 * (fit.first_third_filling ?? 0), 0) })],
    );
  }
  const phase = (name: string, p: PhaseNumbers | null | undefined) => {
    if (!p) return;
    const numbers = { deg: figure(p.bandwidth_deg, 0), n: figure(p.entropy_percent, 0) };
    rows.push([name, `SD ${figure(p.sd_deg)}°, ${say("bandwidth {deg}°, entropy {n} %", numbers)}`]);
  };
  phase(say("Phase of the counts"), results.measures?.phase.counts);
  phase(say("Phase of the motion"), results.measures?.phase.motion);
  const muscle = results.measures;
  if (muscle?.muscle_g) rows.push([muscle.thickness_is === "apparent" ? say("Muscle, apparent") : say("Muscle"), `${figure(muscle.muscle_g, 0)} g (1.05 g/mL)`]);
  return html("dl", {}, ...rows.flatMap(([name, value]) => [html("dt", {}, name), html("dd", {}, value)]));
}

function gateTable({ gates, ed_gate, es_gate }: Results): HTMLElement {
  const mark = (gate: number) => (gate === ed_gate ? " ED" : gate === es_gate ? " ES" : "");
  const row = (name: string, cells: string[]) => html("tr", {}, html("th", { scope: "row" }, name), ...cells.map((c) => html("td", {}, c)));
  return html(
    "table",
    { class: "numbers" },
    html("tbody", {},
      row(say("Gate"), gates.map((_, g) => `${g + 1}${mark(g + 1)}`)),
      row("ms", gates.map((g) => figure(g.time_ms, 0))),
      row(say("Cavity mL"), gates.map((g) => figure(g.endo_ml))),
      ...(gates.some((g) => g.epi_ml !== null) ? [row(say("Outer mL"), gates.map((g) => figure(g.epi_ml)))] : []),
    ),
  );
}

function histogramOf(phase: PhaseNumbers): SVGElement {
  const top = Math.max(...phase.histogram_percent, 1);
  const bars = phase.histogram_percent.map((share, n) =>
    svg("rect", { x: n * phase.bin_deg, y: 60 - (52 * share) / top, width: phase.bin_deg - 0.8, height: (52 * share) / top }),
  );
  const ticks = [0, 90, 180, 270, 360].map((deg) => svg("text", { x: deg, y: 72 }, `${deg}°`));
  return svg("svg", { viewBox: "-14 0 388 76", class: "histogram" }, svg("path", { d: "M0 60H360" }), ...bars, ...ticks);
}

function mapsOf({ polar, results }: Report): HTMLElement[] {
  const measures = results.measures;
  if (!polar || !measures) return [];
  return printed_maps.flatMap((name) => {
    const map = polar.maps.find((m) => m.name === name);
    if (!map) return [];
    const picture = svg("svg", { viewBox: "-122 -122 276 244", class: "polar" });
    drawPolar(picture, polar, map, told(map.title));
    return [html("figure", {}, html("figcaption", {}, titleOfMap(map, measures)), picture)];
  });
}

function heartsOf(scene: SurfaceScene, moments: Parts["moments"]): HTMLElement[] {
  return moments.flatMap(({ name, gate }) =>
    (["anterior", "left"] as const).map((view) =>
      html("figure", {}, scene.picture(gate, view, 560, 360), html("figcaption", {}, (name ? `${name}, ` : "") + (view === "left" ? say("from the left") : say("from the front")))),
    ),
  );
}

function provenanceOf({ results }: Report): HTMLElement {
  const { provenance } = results;
  const files = provenance.inputs.slice(0, most_inputs).map(({ file, sha256 }) => `${file} (SHA-256 ${sha256})`);
  const more = provenance.inputs.length - files.length;
  return html(
    "section",
    { class: "paper-provenance" },
    html("h2", {}, say("Provenance")),
    html("p", {}, `${provenance.program} ${provenance.version}, commit ${provenance.commit || say("unknown")}. ${provenance.command}`),
    html("p", {}, `${say("Input:")} ${files.join("; ")}${more > 0 ? `; ${say("{n} more files", { n: more })}` : ""}. ${say("All options are in results.json.")}`),
    html(
      "p",
      {},
      [
        say("PSF-corrected: surfaces of all gates fitted through the point spread, with 90 % intervals."),
        say("Edge: where the image is steepest; blur makes its volumes small."),
        say("Gaussian profile: 65 % of the deviations of an asymmetric Gaussian; its ejection fraction is too high."),
        say("Perfusion: percent of the wall’s brightest twentieth (counts) or upper quartile (fitted uptake)."),
        say("Polar maps are seen from the apex, anterior wall on top, septum left."),
      ].join(" "),
    ),
  );
}

function section(title: string, ...content: (Node | string)[]): HTMLElement {
  return html("section", {}, html("h2", {}, title), ...content);
}

/** Many flags leave less room: the slices become as small as the sheet needs. */
function fit(sheet: HTMLElement, slices: HTMLElement): void {
  for (let percent = 100; sheet.scrollHeight > sheet.clientHeight && percent > 30; percent -= 5) slices.style.width = `${percent}%`;
}

/** Fills `place`, which must be visible, with two sheets. */
export function buildPaper(place: HTMLElement, { report, painter, walls, scene, moments }: Parts): void {
  const { results } = report;
  const measures = results.measures;
  const cards = html("div", { class: "cards" });
  showCards(cards, results);
  const readings = html("div", {});
  showReadings(readings, results);
  const curve = html("div", { class: "paper-curve" });
  const splash = html("div", { class: "paper-splash" });
  const circles = isCorrected(results) ? say("Circles: cavity with its 90 % interval.") : say("Circles: cavity.");
  const legend = `${circles} ${say("Squares: outer surface. Triangles: wall. Thin dashes: periodic fit.")}`;
  const first = html(
    "article",
    { class: "sheet" },
    head(report, 1),
    verdictOf(report),
    cards,
    section(say("Readings"), readings),
    html(
      "div",
      { class: "paper-pair" },
      section(say("Volumes over the beat"), curve, html("p", { class: "paper-legend" }, legend)),
      section(say("The beat in numbers"), beatOf(report)),
    ),
    section(say("Slices"), splash),
  );
  const phase = measures?.phase.counts ?? measures?.phase.motion;
  const second = html(
    "article",
    { class: "sheet" },
    head(report, 2),
    ...(measures && report.polar ? [section(say("Polar maps"), html("div", { class: "paper-maps" }, ...mapsOf(report)))] : []),
    ...(scene ? [section(say("Surfaces"), html("div", { class: "paper-hearts" }, ...heartsOf(scene, moments)))] : []),
    ...(phase ? [section(phase === measures?.phase.counts ? say("Onset of contraction by counts") : say("Onset of contraction by motion"), histogramOf(phase))] : []),
    ...(measures ? [section(say("Segments"), segmentTable(measures))] : []),
    section(say("Gates"), gateTable(results)),
    provenanceOf(report),
  );
  place.replaceChildren(first, second);
  if (results.study.gates > 1 && walls.length > 0) {
    const still = new Player(results.gates.length, results.study.cycle_ms ?? 1000, () => {});
    new Curve(curve, results, walls, still).draw();
  } else curve.append(say("No beat to show."));
  if (painter && walls.length > 0) new Splash(splash, painter, moments, 8).draw();
  fit(first, splash);
}
