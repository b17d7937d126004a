// The page of a cloud: reads the data written into it and builds the parts.
import { byId, figure, html } from "../dom";
import { showNotes, showOptions, showProvenance } from "../tables";
import { readCloudReport, type Certificate, type CloudReport, type CloudResults } from "./data";
import { pointsOf, Surface, Tiles, type Colouring, type Look } from "./scene";

/** Four figures, for lengths in any unit. */
function length(value: number | null): string {
  return value === null ? "–" : value === 0 ? "0" : Number(value.toPrecision(4)).toString();
}
const percent = (value: number | null) => (value === null ? "–" : `${Number(value.toPrecision(3))} %`);
const count = (value: number) => value.toLocaleString("en");

function showVerdict(place: HTMLElement, results: CloudResults): void {
  const broken = results.levels.filter((level) => !level.certificate.watertight);
  const good = results.watertight;
  place.classList.add(good ? "ok" : "fail");
  place.replaceChildren(
    html("span", { class: `icon ${good ? "ok" : "fail"}`, "aria-hidden": "true" }, good ? "✓" : "✕"),
    html(
      "div",
      {},
      html("h1", {}, good ? "Every level is watertight" : results.levels.length === 0 ? "There is no level" : "Not every level is watertight"),
      html(
        "p",
        {},
        good
          ? "Closed, manifold, oriented outwards and free of self-intersections, by exact tests."
          : broken.map((level) => `Level ${level.level}: ${faultsOf(level.certificate).join(", ")}.`).join(" "),
      ),
    ),
  );
}

function faultsOf(c: Certificate): string[] {
  return [
    c.closed ? "" : "not closed",
    c.manifold ? "" : "not manifold",
    c.oriented ? "" : "not oriented alike",
    c.outward ? "" : "turned inside out",
    c.self_intersections ? `${count(c.self_intersections)} pairs of triangles meet` : "",
    c.flat_triangles ? `${count(c.flat_triangles)} flat triangles` : "",
  ].filter(Boolean);
}

function showCertificates(place: HTMLElement, results: CloudResults): void {
  const yes = (value: boolean) => html("td", { class: value ? "good" : "bad" }, value ? "yes" : "no");
  const none = (value: number) => html("td", { class: value === 0 ? "good" : "bad" }, count(value));
  const heads = [
    "Level", "Triangles", "Watertight", "Points to mesh, mean", "largest", "Mesh to points, mean", "largest", "Smallest angle", "1 % of angles below", "Parts", "Genus",
    "Meeting pairs", "Flat", "Closed", "Manifold", "Oriented", "Outwards", "Volume", "Area", "Vertices", "Of a plain tessellation",
  ];
  const rows = results.levels.map((level) => {
    const c = level.certificate;
    const { cloud_to_mesh: to, mesh_to_cloud: from } = c.distances;
    const plain = (...texts: string[]) => texts.map((text) => html("td", {}, text));
    return html(
      "tr",
      { "data-level": level.level },
      html("th", { scope: "row" }, String(level.level)),
      ...plain(count(level.triangles)),
      yes(c.watertight),
      ...plain(percent(to.mean_percent), percent(to.largest_percent), percent(from.mean_percent), percent(from.largest_percent)),
      ...plain(`${figure(c.angles_deg.smallest)}°`, `${figure(c.angles_deg.percentile_1)}°`, String(c.components), c.genus === null ? "–" : String(c.genus)),
      none(c.self_intersections), none(c.flat_triangles), yes(c.closed), yes(c.manifold), yes(c.oriented), yes(c.outward),
      ...plain(length(c.volume), length(c.area), count(level.vertices), percent(level.share_of_plain_tessellation_percent)),
    );
  });
  place.replaceChildren(
    html(
      "table",
      { class: "numbers" },
      html("thead", {}, html("tr", {}, ...heads.map((head) => html("th", { scope: "col" }, head)))),
      html("tbody", {}, ...rows),
    ),
    html("p", { class: "faint" }, "Distances in percent of the diagonal of the cloud's box. Over a hole of the cloud the mesh is far from the points however good it is."),
  );
}

function showCloud(place: HTMLElement, results: CloudResults): void {
  const c = results.cloud;
  const files = c.files.map((f) => `${f.format}: ${count(f.points)} points${f.triangles ? ` of a surface of ${count(f.triangles)} triangles` : ""}`);
  const rows: [string, string][] = [
    [c.files.length === 1 ? "File" : "Files", files.join("; ")],
    ["Points", count(c.points)],
    ["Dropped", `${count(c.not_finite)} not finite, ${count(c.duplicates)} repeated, ${count(c.outliers)} outliers`],
    ["Used", count(c.points_used)],
    ["With", [c.has_normals ? "normals" : "", c.has_colours ? "colours" : "", c.scans > 1 ? `${c.scans} scans` : ""].filter(Boolean).join(", ") || "places alone"],
    ["Diagonal", length(c.diagonal)],
    ["Spacing", length(c.spacing)],
    ["Noise", length(c.noise)],
    ["Parts, handles", `${c.parts}, ${c.genus}`],
  ];
  place.replaceChildren(html("dl", {}, ...rows.flatMap(([name, value]) => [html("dt", {}, name), html("dd", {}, value)])));
}

/** What stands over each tile. */
function labelTiles(place: HTMLElement, report: CloudReport): void {
  const labels = html("div", { class: "tile-labels" });
  place.append(labels);
  const label = (...children: (Node | string)[]) => labels.append(html("div", { class: "tile-label" }, ...children));
  const shown = report.points.positions.length / 3, used = report.results.cloud.points_used;
  label(html("b", {}, "Cloud"), shown < used ? `${count(shown)} of ${count(used)} points` : `${count(used)} points`);
  report.levels.forEach(({ numbers }) => {
    const c = numbers.certificate;
    label(
      html("b", {}, `Level ${numbers.level}: ${count(numbers.triangles)} triangles`),
      html("span", { class: c.watertight ? "good" : "bad" }, c.watertight ? "watertight" : "not watertight"),
      ` · mean distance ${percent(c.distances.cloud_to_mesh.mean_percent)}`,
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
      t === 1 ? `level ${numbers.level}, ${count(numbers.triangles)} triangles` : `level ${numbers.level + 1} to ${numbers.level}: ${Math.round(100 * t)} %`;
    document.documentElement.dataset.morph = `${numbers.level} ${t.toFixed(3)}`;
    view.render();
  };
  slider.addEventListener("input", draw);
  return (look) => {
    dressed = look;
    draw();
  };
}

function build3d(report: CloudReport): void {
  const tiles = new Tiles(byId("tiles"), "The cloud and its levels of detail. Drag to turn.", report.radius, 42);
  const morph = new Tiles(byId("morph-view"), "A level that turns into the next. Drag to turn.", report.radius);
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

  const look: Look = { colouring: "error", full: report.full_error, wire: false, flat: false, points: false };
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
  const keys: Record<string, () => void> = { r: () => tiles.reset() };
  for (const name of ["wire", "flat", "points"] as const) {
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
  byId("reset").addEventListener("click", keys.r!);
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || (event.target as HTMLElement).closest("input, select")) return;
    keys[event.key.toLowerCase()]?.();
  });
  dress();
}

async function start(): Promise<void> {
  const report = await readCloudReport(byId("data").textContent ?? "");
  const { results } = report;
  byId("subject").textContent = `${count(results.cloud.points)} points · ${results.levels.map((l) => count(l.triangles)).join(", ")} triangles`;
  showVerdict(byId("verdict"), results);
  showCertificates(byId("certificates"), results);
  showCloud(byId("cloud"), results);
  showNotes(byId("notes"), results.notes);
  showProvenance(byId("provenance"), results);
  showOptions(byId("options"), results);
  try {
    build3d(report);
  } catch {
    for (const id of ["tiles", "morph-view"])
      byId(id).replaceChildren(html("div", { class: "message" }, html("strong", {}, "3D needs WebGL"), html("p", {}, "This browser offers none. The numbers are complete without it.")));
  }
  document.documentElement.dataset.ready = "true";
}

start().catch((error: unknown) => {
  const place = byId("verdict");
  place.classList.add("fail");
  place.replaceChildren(html("div", {}, html("h1", {}, "This report cannot be shown"), html("p", {}, `${String(error)}. The numbers are in results.json and results.csv beside it.`)));
});
