// The page of a cloud: reads the data written into it and builds the parts.
import { Vector3 } from "three";

import { byId, figure, html } from "../dom";
import { showNotes, showOptions, showProvenance } from "../tables";
import { isSound, readCloudReport, type Certificate, type CloudReport, type CloudResults, type Level, type LevelNumbers } from "./data";
import { buildTheme } from "../theme";
import { say, told, words } from "../words";
import { pointsOf, Surface, Tiles, type Colouring, type Look } from "./scene";

/** Four figures, for lengths in any unit. */
function length(value: number | null): string {
  return value === null ? "–" : value === 0 ? "0" : Number(value.toPrecision(4)).toString();
}
const percent = (value: number | null) => (value === null ? "–" : `${Number(value.toPrecision(3))} %`);
/** With commas in English, else with spaces: a comma may begin the decimals elsewhere. */
const count = (value: number) => value.toLocaleString("en").replaceAll(",", document.documentElement.lang === "en" ? "," : "\u202f");

const loops = (number: number) => (number === 1 ? say("1 boundary loop") : say("{n} boundary loops", { n: count(number) }));

const verdicts = {
  ok: { icon: "✓", title: say("The points support every level"), text: say("Every level is closed, manifold, oriented outwards and free of self-intersections, by exact tests.") },
  check: { icon: "!", title: say("Look before you use it"), text: say("Every level is watertight. But the points leave doubt whether it is the right body:") },
  fail: { icon: "✕", title: say("Do not use it"), text: "" },
};

function textOf(results: CloudResults): string {
  if (results.boundary === "close") return verdicts[results.verdict].text;
  const number = { loops: loops(results.cloud.boundary_loops) };
  const what = results.boundary === "trim" ? say("An open surface with {loops}, trimmed to the points", number) : say("An open surface with {loops}", number);
  if (results.verdict === "ok") return say("{surface}: every level is manifold, oriented and free of self-intersections, by exact tests.", { surface: what });
  return results.verdict === "check" ? say("{surface}. But the points leave doubt whether it is the right one:", { surface: what }) : "";
}

function showVerdict(place: HTMLElement, results: CloudResults): void {
  const { icon, title } = verdicts[results.verdict];
  const is_closed = results.boundary === "close";
  const broken = results.levels.filter((level) => !isSound(results, level));
  const reasons = results.notes.filter((note) => note.severity !== "info").map((note) => told(note.message));
  const told_broken = (level: LevelNumbers) => {
    const facts = { level: level.level, faults: faultsOf(level.certificate, is_closed).join(", ") };
    return is_closed ? say("Level {level} is not watertight: {faults}.", facts) : say("Level {level} is not a sound open surface: {faults}.", facts);
  };
  reasons.unshift(...broken.map(told_broken));
  if (results.levels.length === 0) reasons.unshift(say("There is no level."));
  place.classList.add(results.verdict);
  place.replaceChildren(
    html("span", { class: `icon ${results.verdict}`, "aria-hidden": "true" }, icon),
    html("div", {}, html("h1", {}, title), html("p", {}, textOf(results)), html("ul", {}, ...reasons.map((reason) => html("li", {}, reason)))),
  );
}

function faultsOf(c: Certificate, is_closed: boolean): string[] {
  return [
    c.closed || !is_closed ? "" : say("not closed"),
    c.boundary_loops > 0 || is_closed ? "" : say("without a boundary loop"),
    c.manifold ? "" : say("not manifold"),
    c.oriented ? "" : say("not oriented alike"),
    c.outward || !is_closed ? "" : say("turned inside out"),
    c.self_intersections ? say("{n} pairs of triangles meet", { n: count(c.self_intersections) }) : "",
    c.flat_triangles ? say("{n} flat triangles", { n: count(c.flat_triangles) }) : "",
  ].filter(Boolean);
}

/** One column per level: a row per level would be wider than a screen. */
function showCertificates(place: HTMLElement, results: CloudResults): void {
  type Cell = { text: string; state?: "good" | "bad" };
  const yes = (value: boolean): Cell => ({ text: value ? say("yes") : say("no"), state: value ? "good" : "bad" });
  type Row = [string, (level: LevelNumbers) => Cell];
  const none = (value: number): Cell => ({ text: count(value), state: value === 0 ? "good" : "bad" });
  const closed: Row[] = [
    [say("Watertight"), (l) => yes(l.certificate.watertight)],
    [say("Closed"), (l) => yes(l.certificate.closed)],
    [say("Outwards"), (l) => yes(l.certificate.outward)],
  ];
  const open: Row[] = [
    [say("Sound"), (l) => yes(isSound(results, l))],
    [say("Boundary loops"), (l) => ({ text: count(l.certificate.boundary_loops) })],
  ];
  const rows: Row[] = [
    [say("Triangles"), (l) => ({ text: count(l.triangles) })],
    [say("Vertices"), (l) => ({ text: count(l.vertices) })],
    [say("Of a plain tessellation"), (l) => ({ text: percent(l.share_of_plain_tessellation_percent) })],
    ...(results.boundary === "close" ? closed : open),
    [say("Manifold"), (l) => yes(l.certificate.manifold)],
    [say("Oriented"), (l) => yes(l.certificate.oriented)],
    [say("Meeting pairs"), (l) => none(l.certificate.self_intersections)],
    [say("Flat triangles"), (l) => none(l.certificate.flat_triangles)],
    [say("Parts"), (l) => ({ text: String(l.certificate.components) })],
    [say("Genus"), (l) => ({ text: l.certificate.genus === null ? "–" : String(l.certificate.genus) })],
    [say("Points to mesh, mean"), (l) => ({ text: percent(l.certificate.distances.cloud_to_mesh.mean_percent) })],
    [say("Points to mesh, largest"), (l) => ({ text: percent(l.certificate.distances.cloud_to_mesh.largest_percent) })],
    [say("Mesh to points, mean"), (l) => ({ text: percent(l.certificate.distances.mesh_to_cloud.mean_percent) })],
    [say("Mesh to points, largest"), (l) => ({ text: percent(l.certificate.distances.mesh_to_cloud.largest_percent) })],
    [say("Smallest angle"), (l) => ({ text: `${figure(l.certificate.angles_deg.smallest)}°` })],
    [say("1 % of angles below"), (l) => ({ text: `${figure(l.certificate.angles_deg.percentile_1)}°` })],
    [say("Volume"), (l) => ({ text: length(l.certificate.volume) })],
    [say("Area"), (l) => ({ text: length(l.certificate.area) })],
  ];
  const heads = results.levels.map((level) => html("th", { scope: "col", "data-level": level.level }, say("Level {level}", { level: level.level })));
  const body = rows.map(([name, cell]) => {
    const cells = results.levels.map(cell);
    return html("tr", {}, html("th", { scope: "row" }, name), ...cells.map(({ text, state }) => html("td", state ? { class: state } : {}, text)));
  });
  place.replaceChildren(
    html("table", { class: "numbers" }, html("thead", {}, html("tr", {}, html("th", {}, ""), ...heads)), html("tbody", {}, ...body)),
    html("p", { class: "faint" }, say("Distances in percent of the diagonal of the cloud's box. Over a hole of the cloud the mesh is far from the points however good it is.")),
  );
}

function showCloud(place: HTMLElement, results: CloudResults): void {
  const { cloud: c, support: s } = results;
  const files = c.files.map((f) =>
    f.triangles
      ? say("{format}: {n} points of a surface of {m} triangles", { format: f.format, n: count(f.points), m: count(f.triangles) })
      : say("{format}: {n} points", { format: f.format, n: count(f.points) }),
  );
  const rows: [string, string][] = [
    [c.files.length === 1 ? say("File") : say("Files"), files.join("; ")],
    [say("Points"), count(c.points)],
    [say("Dropped"), say("{a} not finite, {b} repeated, {c} outliers", { a: count(c.not_finite), b: count(c.duplicates), c: count(c.outliers) })],
    [say("Used"), count(c.points_used)],
    [say("With"), [c.has_normals ? say("normals") : "", c.has_colours ? say("colours") : "", c.scans > 1 ? say("{n} scans", { n: c.scans }) : ""].filter(Boolean).join(", ") || say("places alone")],
    [say("Diagonal"), length(c.diagonal)],
    [say("Spacing"), length(c.spacing)],
    [say("Noise"), length(c.noise)],
    [say("Parts, handles"), say("{parts}, {handles}; so at {share} of the levels around", { parts: c.parts, handles: c.genus, share: percent(s.firm_percent) })],
    [say("Points off the surface"), say("{share}; far off: {far}", { share: percent(s.points_off_percent), far: percent(s.points_left_out_percent) })],
    [say("Surface made up"), say("{share}, up to {far} of the diagonal from the points", { share: percent(s.made_up_percent), far: percent(s.made_up_largest_percent) })],
    [say("Faced by no point"), say("a part that ought to hold {n} of them", { n: count(Math.round(s.unfaced_points ?? 0)) })],
    [say("Thin walls and gaps"), say("{share}; gaps: {gaps}", { share: percent(s.thin_percent), gaps: percent(s.gaps_percent) })],
    [say("Directions in doubt"), percent(s.turned_percent)],
  ];
  place.replaceChildren(html("dl", {}, ...rows.flatMap(([name, value]) => [html("dt", {}, name), html("dd", {}, value)])));
}

interface WorstPlace {
  vertex: number;
  badness: number; // in supported distances
  text: string;
}

/** The places of a level where most is made up, or the points are farthest off, well apart from each other. */
function worstPlaces(level: Level, results: CloudResults): WorstPlace[] {
  const most = 6, within = results.support.within ?? 0, diagonal = results.cloud.diagonal ?? 0;
  if (!(within > 0 && diagonal > 0)) return [];
  const share = (distance: number) => percent((100 * distance) / diagonal);
  const all = Array.from(level.confidence, (confidence, vertex): WorstPlace => {
    const error = level.errors[vertex]!;
    if (confidence < 1) return { vertex, badness: 1 / confidence, text: say("made up, {share} of the diagonal from points that support it", { share: share(within / confidence) }) };
    return { vertex, badness: error / within, text: say("the points lie {share} of the diagonal off", { share: share(error) }) };
  }).sort((a, b) => b.badness - a.badness);
  const found: WorstPlace[] = [];
  const apart = (a: number, b: number) => Math.hypot(...[0, 1, 2].map((axis) => level.positions[3 * a + axis]! - level.positions[3 * b + axis]!));
  for (const place of all) {
    if (found.length === most || !(place.badness > 0)) break;
    if (found.every((other) => apart(other.vertex, place.vertex) > 0.12 * diagonal)) found.push(place);
  }
  return found;
}

function showWorst(place: HTMLElement, level: Level | undefined, results: CloudResults, fly: (vertex: number) => void): void {
  const worst = level ? worstPlaces(level, results) : [];
  const items = worst.map(({ vertex, text }) => {
    const button = html("button", {}, text);
    button.addEventListener("click", () => fly(vertex));
    return html("li", {}, button);
  });
  place.replaceChildren(items.length > 0 ? html("ol", {}, ...items) : html("p", { class: "faint" }, say("None.")));
}

function wordFor(results: CloudResults, level: LevelNumbers): string {
  const is_sound = isSound(results, level);
  if (results.boundary === "close") return is_sound ? say("watertight") : say("not watertight");
  return is_sound ? say("open, {loops}", { loops: loops(level.certificate.boundary_loops) }) : say("not sound");
}

/** What stands over each tile. */
function labelTiles(place: HTMLElement, report: CloudReport): void {
  const { results } = report;
  const labels = html("div", { class: "tile-labels" });
  place.append(labels);
  const label = (...children: (Node | string)[]) => labels.append(html("div", { class: "tile-label" }, ...children));
  const shown = report.points.positions.length / 3, used = results.cloud.points_used;
  label(html("b", {}, say("Cloud")), shown < used ? say("{n} of {all} points", { n: count(shown), all: count(used) }) : say("{n} points", { n: count(used) }));
  report.levels.forEach(({ numbers }) => {
    const c = numbers.certificate;
    label(
      html("b", {}, say("Level {level}: {n} triangles", { level: numbers.level, n: count(numbers.triangles) })),
      html("span", { class: isSound(results, numbers) ? "good" : "bad" }, wordFor(results, numbers)),
      ` · ${say("mean distance {share}", { share: percent(c.distances.cloud_to_mesh.mean_percent) })}`,
    );
  });
}

/** The surface that turns into the next; returns what draws it anew. */
function buildMorph(view: Tiles, report: CloudReport): (look: Look) => void {
  const last = report.levels.length - 1;
  const surface = new Surface(report.levels[0]!);
  view.add(surface.group);
  const slider = byId<HTMLInputElement>("morph");
  slider.disabled = last === 0;
  let shown = report.levels[0]!;
  let dressed: Look;
  const draw = () => {
    // The slider runs from the coarsest level to the finest.
    const fine = last * (1 - slider.valueAsNumber / 1000);
    const level = Math.floor(fine);
    const t = 1 - (fine - level);
    const whole = report.levels[level]!, drawn = t < 1 ? (whole.growing ?? whole) : whole;
    if (drawn !== shown) surface.choose((shown = drawn));
    surface.morph(t);
    surface.dress(dressed);
    const numbers = report.levels[level]!.numbers;
    byId("morph-now").textContent =
      t === 1
        ? say("level {level}, {n} triangles", { level: numbers.level, n: count(numbers.triangles) })
        : say("level {from} to {to}: {n} %", { from: numbers.level + 1, to: numbers.level, n: Math.round(100 * t) });
    document.documentElement.dataset.morph = `${numbers.level} ${t.toFixed(3)}`;
    view.render();
  };
  slider.addEventListener("input", draw);
  return (look) => {
    dressed = look;
    draw();
  };
}

type Keys = Record<string, () => void>;

/** What each letter does, for more to be added. */
function buildKeys(keys: Keys): Keys {
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.target as HTMLElement).closest("input, select")) return;
    keys[event.key.toLowerCase()]?.();
  });
  return keys;
}

function build3d(report: CloudReport, keys: Keys): void {
  const tiles = new Tiles(byId("tiles"), say("The cloud and its levels of detail. Drag to turn."), report.radius, 42);
  const morph = new Tiles(byId("morph-view"), say("A level that turns into the next. Drag to turn."), report.radius);
  labelTiles(byId("tiles"), report);
  tiles.add(pointsOf(report, 1.6));
  const over = report.levels.map(() => pointsOf(report, 1.2));
  const surfaces = report.levels.map((level) => new Surface(level));
  surfaces.forEach((surface, n) => tiles.add(surface.group, over[n]!));
  const dressMorph = report.levels.length > 0 ? buildMorph(morph, report) : () => {};
  let leading = false;
  for (const [one, other] of [[tiles, morph], [morph, tiles]] as const)
    one.controls.addEventListener("change", () => {
      if (leading) return;
      leading = true;
      other.follow(one);
      leading = false;
    });

  const finest = report.levels[0];
  showWorst(byId("worst"), finest, report.results, (vertex) => {
    const place = new Vector3().fromArray(finest!.positions, 3 * vertex);
    tiles.flyTo(place, surfaces[0]!.normalAt(vertex));
    document.documentElement.dataset.flown = String(vertex);
  });
  const look: Look = { colouring: "error", full: report.full_error, wire: false, flat: false, points: false, made_up: true };
  const dress = () => {
    for (const surface of surfaces) surface.dress(look);
    for (const points of over) points.visible = look.points;
    byId("ramp-end").textContent = `${length(look.full)} (${percent(report.results.cloud.diagonal ? (100 * look.full) / report.results.cloud.diagonal : null)})`;
    byId("ramp").hidden = byId("scale-label").hidden = look.colouring !== "error";
    dressMorph(look);
    tiles.render();
  };
  const colouring = byId<HTMLSelectElement>("colouring");
  if (!report.results.cloud.has_colours) colouring.querySelector<HTMLOptionElement>('[value="own"]')!.disabled = true;
  colouring.addEventListener("change", () => {
    look.colouring = colouring.value as Colouring;
    dress();
  });
  byId<HTMLInputElement>("scale").addEventListener("input", (event) => {
    look.full = (report.full_error * (event.target as HTMLInputElement).valueAsNumber) / 100;
    dress();
  });
  keys.r = () => tiles.reset();
  for (const name of ["wire", "flat", "points", "made_up"] as const) {
    keys[name[0]!] = () => {
      look[name] = !look[name];
      byId(`toggle-${name}`).setAttribute("aria-pressed", String(look[name]));
      dress();
    };
    byId(`toggle-${name}`).addEventListener("click", keys[name[0]!]!);
  }
  let z_up = false;
  keys.z = () => {
    z_up = !z_up;
    byId("toggle-z").setAttribute("aria-pressed", String(z_up));
    for (const view of [tiles, morph]) view.stand(z_up);
  };
  byId("toggle-z").addEventListener("click", keys.z);
  byId("reset").addEventListener("click", keys.r);
  dress();
}

async function start(): Promise<void> {
  words.translate(document);
  const keys = buildKeys({ l: buildTheme(byId("theme")) });
  const report = await readCloudReport(byId("data").textContent ?? "");
  const { results } = report;
  byId("subject").textContent = `${say("{n} points", { n: count(results.cloud.points) })} · ${say("{list} triangles", { list: results.levels.map((l) => count(l.triangles)).join(", ") })}`;
  showVerdict(byId("verdict"), results);
  showCertificates(byId("certificates"), results);
  showCloud(byId("cloud"), results);
  showNotes(byId("notes"), results.notes);
  showProvenance(byId("provenance"), results);
  showOptions(byId("options"), results);
  try {
    build3d(report, keys);
  } catch {
    for (const id of ["tiles", "morph-view"])
      byId(id).replaceChildren(html("div", { class: "message" }, html("strong", {}, say("3D needs WebGL")), html("p", {}, say("This browser offers none. The numbers are complete without it."))));
  }
  document.documentElement.dataset.ready = "true";
}

start().catch((error: unknown) => {
  const place = byId("verdict");
  place.classList.add("fail");
  place.replaceChildren(html("div", {}, html("h1", {}, say("This report cannot be shown")), html("p", {}, `${String(error)}. ${say("The numbers are in results.json and results.csv beside it.")}`)));
});
