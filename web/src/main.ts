// The page of a result: reads the data written into it, builds the parts, and moves them with one clock.
import { Wall } from "./cycle";
import { Cursor, placeInHeart, placeOnMap, sampleNear, toWorld } from "./cursor";
import { ContourView } from "./contours";
import { shareBeat } from "./beat";
import { buildHand, joinHost } from "./correct";
import { Curve } from "./curve";
import { isCorrected, readReport, toVoxels, walls as wall_names, type Report, type Results } from "./data";
import { byId, colour, figure, html, svg } from "./dom";
import { FieldView } from "./field";
import { buildFilm } from "./film";
import { buildLayouts } from "./layouts";
import { MotionView } from "./motion";
import { Painter, type Overlay } from "./painter";
import { buildPaper } from "./paper";
import { Player } from "./player";
import { PolarView } from "./polar";
import { Residuals } from "./residuals";
import { SurfaceScene, type ViewName } from "./scene";
import { Slices } from "./slices";
import { Splash } from "./splash";
import { isBloodPool, showCards, showGates, showNotes, showOptions, showProvenance, showReadings, showVerdict, subjectOf } from "./tables";
import { buildTheme } from "./theme";
import { say, words } from "./words";

const default_cycle_ms = 1000;

/** A `fill` that is a variable is one of the page; others are drawn on images, whose dark ground they keep. */
function legendItem(name: string, fill: string, shape: "dot" | "line" | "square" = "dot"): HTMLElement {
  const mark = svg("svg", { viewBox: "0 0 16 10", class: fill.startsWith("#") ? "swatch of-image" : "swatch", "aria-hidden": "true" });
  mark.append(
    shape === "line"
      ? svg("path", { d: "M0 5h16", stroke: fill, "stroke-width": 2.5 })
      : shape === "square"
        ? svg("rect", { x: 4, y: 1, width: 8, height: 8, fill })
        : svg("circle", { cx: 8, cy: 5, r: 4.5, fill }),
  );
  return html("span", {}, mark, name);
}

function message(place: HTMLElement, title: string, text: string): void {
  place.append(html("div", { class: "message" }, html("strong", {}, title), html("p", {}, text)));
}

function buildScene(report: Report, walls: Wall[], player: Player): SurfaceScene | null {
  const place = byId("scene");
  const legend = byId("scene-legend");
  const missing = wall_names.filter((name) => !walls.some((wall) => wall.name === name));
  if (walls.length === 0 || !report.pictures) {
    byId("compass").remove();
    byId("views").remove();
    message(place, say("No surface was found"), say("The slices below show the edges the program had to work with."));
    return null;
  }
  let scene: SurfaceScene;
  try {
    scene = new SurfaceScene(place, byId<SVGSVGElement>("compass"), walls, report.pictures.grid, report.polar);
  } catch {
    byId("compass").remove();
    byId("views").remove();
    message(place, say("3D needs WebGL"), say("This browser offers none. Slices, curve and numbers are complete without it."));
    return null;
  }
  const names = { endo: say("Endocardium"), epi: say("Epicardium") };
  const items = walls.map((wall) => ({ wall, text: html("b", {}) }));
  legend.replaceChildren(
    ...items.map(({ wall, text }) => {
      const item = legendItem(names[wall.name], colour[wall.name], wall.name === "endo" ? "dot" : "square");
      item.append(" ", text);
      return item;
    }),
    ...missing.map((name) =>
      isBloodPool(report.results)
        ? html("span", {}, say("blood pool: no wall is seen"))
        : html("span", { class: "missing" }, say("{wall} was not found", { wall: names[name] })),
    ),
  );
  player.listen((phase) => {
    scene.show(phase);
    const gate = report.results.gates[player.gate]!;
    for (const { wall, text } of items) text.textContent = `${figure(gate[`${wall.name}_ml`])} mL`;
  });
  for (const button of byId("views").querySelectorAll<HTMLButtonElement>("[data-view]"))
    button.addEventListener("click", () => scene.look(button.dataset.view as ViewName));
  return scene;
}

function buildCurve(results: Results, walls: Wall[], player: Player): void {
  const place = byId("curve");
  if (results.study.gates < 2) {
    message(place, say("No volume curve"), say("This study is not gated: it shows one moment, without a beat and without an ejection fraction."));
    return;
  }
  if (walls.length === 0) {
    message(place, say("No volume curve"), say("There is no surface to measure."));
    return;
  }
  const legend = [
    legendItem(say("Cavity"), "var(--endo)"),
    legendItem(say("Outer"), "var(--epi)", "square"),
    legendItem(say("Wall"), "var(--wall)", "line"),
    ...(isCorrected(results)
      ? [
          legendItem(say("90 % of the cavity"), "color-mix(in srgb, var(--endo) 40%, transparent)", "square"),
          html("span", { class: "faint" }, say("dots fitted through the point spread, lines between the gates interpolated")),
        ]
      : [html("span", { class: "faint" }, say("dots measured, lines between the gates interpolated"))]),
    ...(results.measures?.function ? [legendItem(say("fit of {n} waves", { n: results.measures.function.waves }), "var(--text)", "line")] : []),
  ];
  byId("curve-legend").replaceChildren(...legend);
  new Curve(place, results, walls, player);
}

function buildSlices(painter: Painter | null, cursor: Cursor | null, fitted: boolean, player: Player, point: (segment: number) => void): Slices | null {
  const place = byId("slices");
  if (!painter || !cursor) {
    message(place, say("No images"), say("The result holds no image data."));
    return null;
  }
  const slices = new Slices(place, painter, cursor, point);
  const bin = painter.pictures.bin;
  byId("slice-legend").replaceChildren(
    legendItem(say("endo border"), colour.endo, "square"),
    legendItem(say("epi border"), colour.epi, "square"),
    legendItem(fitted ? say("endo, fitted") : say("endo surface"), colour.endo, "line"),
    legendItem(fitted ? say("epi, fitted") : say("epi surface"), colour.epi, "line"),
    legendItem(say("other edges"), colour.edge, "square"),
    html("span", { id: "before-legend", hidden: true, class: "before" }, legendItem(say("before, dashed"), "#ffffffb0", "line")),
    ...(bin > 1 ? [html("span", { class: "missing" }, say("large study: pixels shown are means of {n} × {n}", { n: bin }))] : []),
  );
  byId<HTMLInputElement>("brightness").addEventListener("input", (event) => {
    painter.overlay.brightness = (event.target as HTMLInputElement).valueAsNumber / 100;
    slices.draw();
  });
  let drawn = -1;
  player.listen(() => {
    if (player.gate === drawn) return;
    drawn = slices.gate = player.gate;
    slices.draw();
  });
  return slices;
}

function press(id: string, on: boolean): void {
  byId(id).setAttribute("aria-pressed", String(on));
}

function buildToggles(painter: Painter | null, slices: Slices | null, scene: SurfaceScene | null): Record<string, () => void> {
  const keys: Record<string, () => void> = {};
  const overlays = [
    ["c", "contours"],
    ["m", "sections"],
    ["e", "edges"],
    ["f", "whole"],
  ] as const satisfies readonly (readonly [string, keyof Overlay])[];
  for (const [key, name] of overlays) {
    const button = byId<HTMLButtonElement>(`toggle-${name}`);
    button.disabled = slices === null;
    if (!slices || !painter) continue;
    keys[key] = () => {
      painter.overlay[name] = !painter.overlay[name];
      press(button.id, painter.overlay[name]);
      slices.layOut();
    };
    button.addEventListener("click", keys[key]);
  }
  if (scene) {
    let wires = false;
    keys.w = () => {
      wires = !wires;
      scene.wires = wires;
      press("toggle-wire", wires);
    };
    byId("toggle-wire").addEventListener("click", keys.w);
  }
  return keys;
}

function buildHelp(): () => void {
  const dialog = byId<HTMLDialogElement>("keys");
  const rows: [string, string][] = [
    [say("Space"), say("play or pause the beat")],
    ["← →", say("gate before, next gate")],
    ["↑ ↓", say("slice towards the base, towards the apex")],
    ["C", say("labelled border voxels on the slices")],
    ["M", say("cuts through the surfaces on the slices")],
    ["E", say("all edges the detector found")],
    ["F", say("whole field of view or the heart")],
    ["W", say("triangles of the surfaces")],
    [say("1 to 6"), say("what is shown: everything, surfaces, slices, both, polar map, curve")],
    ["H", say("correct by hand: handles and a brush on the slices")],
    ["X", say("full screen")],
    ["L", say("light or dark page")],
    [say("Shift + arrows"), say("turn the surfaces")],
    ["?", say("this list")],
  ];
  const close = html("button", { class: "primary", type: "button" }, say("Close"));
  close.addEventListener("click", () => dialog.close());
  dialog.replaceChildren(
    html("h2", { id: "keys-title" }, say("Keys")),
    html("dl", {}, ...rows.flatMap(([key, what]) => [html("dt", {}, html("kbd", {}, key)), html("dd", {}, what)])),
    html("p", {}, say("Drag the surfaces to turn them. Click on them, on the polar map or in a slice to move the cross that all of them mark: the three planes go through it. Drag the cursor of the curve to a moment of the beat. Slice 1 is the apex. Letters on the slices are directions of the patient: left, right, anterior, posterior, superior, inferior.")),
    close,
  );
  const toggle = () => (dialog.open ? dialog.close() : dialog.showModal());
  byId("help").addEventListener("click", toggle);
  return toggle;
}

function buildKeys(player: Player, slices: Slices | null, scene: SurfaceScene | null, toggles: Record<string, () => void>, help: () => void): void {
  const turns: Record<string, [number, number]> = { ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12] };
  const plain: Record<string, () => void> = {
    ArrowLeft: () => player.step(-1),
    ArrowRight: () => player.step(1),
    ArrowUp: () => slices?.choose(slices.slice + 1),
    ArrowDown: () => slices?.choose(slices.slice - 1),
    " ": () => player.toggle(),
    "?": help,
    ...toggles,
  };
  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target as HTMLElement;
    // Controls keep the keys that are theirs.
    if (target.closest("select, input, dialog") && event.key !== "?") return;
    if (event.key === " " && target.closest("button, summary, a")) return;
    const turn = event.shiftKey ? turns[event.key] : undefined;
    const action = turn ? () => scene?.turn(...turn) : plain[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action) return;
    event.preventDefault();
    action();
  });
}

function buildTransport(results: Results): Player {
  const gates = Math.max(results.gates.length, 1);
  const player = new Player(gates, results.study.cycle_ms ?? default_cycle_ms, () => {
    press("play", player.playing);
    byId("play").setAttribute("aria-label", player.playing ? say("Pause") : say("Play"));
    document.documentElement.dataset.playing = String(player.playing);
  });
  byId("play").addEventListener("click", () => player.toggle());
  byId("back").addEventListener("click", () => player.step(-1));
  byId("forward").addEventListener("click", () => player.step(1));
  byId<HTMLSelectElement>("speed").addEventListener("change", (event) => {
    player.speed = Number((event.target as HTMLSelectElement).value);
  });
  for (const id of ["play", "back", "forward", "speed"]) byId<HTMLButtonElement>(id).disabled = gates < 2;
  player.listen(() => {
    const time = results.gates[player.gate]?.time_ms ?? null;
    byId("gate").textContent =
      gates < 2 ? say("not gated") : say("Gate {gate} of {gates}", { gate: player.gate + 1, gates }) + (time === null ? "" : ` · ${figure(time, 0)} ms`);
    document.documentElement.dataset.gate = String(player.gate + 1);
  });
  return player;
}

function buildPolar(report: Report, scene: SurfaceScene | null, player: Player, cursor: Cursor | null, point: (segment: number) => void): PolarView | null {
  const { polar, results } = report;
  if (!polar || !results.measures) {
    byId("polar-panel").remove();
    byId("segments-panel").remove();
    return null;
  }
  const { thickness_is } = results.measures;
  byId("segments-remark").textContent =
    thickness_is === null
      ? say("An image of the blood pool: how the rim of the cavity moves. Of the wall nothing is seen.")
      : thickness_is === "apparent"
        ? say("Thickness between edges of a blurred image is apparent: mostly the camera’s.")
        : say("±: half of the 90 % interval. Numbers read from counts have none.");
  if (!scene) byId("polar-paint").closest("label")!.style.display = "none";
  const endo = () => ({ mesh: report.surfaces?.endo[player.gate], samples: polar.samples[player.gate] });
  const go = (rho: number, deg: number) => {
    const { mesh, samples } = endo();
    const at = mesh && samples && placeInHeart(polar, samples, mesh, rho, deg);
    if (at) cursor?.move(at);
  };
  return new PolarView(polar, results.measures, point, go, (map) => scene?.paintMap(map));
}

/** The cursor starts in the middle of the heart, in the slice with the widest border. */
function cursorOf(painter: Painter): Cursor {
  const { grid, pictures, middle } = painter;
  const widest = pictures.labels[0]?.big_slice ?? -1;
  return new Cursor(grid.dims, [...middle, widest >= 0 ? widest : Math.floor(grid.dims[2] / 2)]);
}

/** Lets the surfaces and the polar map mark the cursor of the slices, and move it. */
function linkCursor(cursor: Cursor, report: Report, painter: Painter, player: Player, scene: SurfaceScene | null, view: PolarView | null): void {
  const { grid } = painter;
  scene?.followClicks((world) => cursor.move(toVoxels(grid, new Float32Array(world))));
  cursor.listen((at) => scene?.markCursor(toWorld(grid, at)));
  const { polar, surfaces } = report;
  if (!view || !polar || !surfaces) return;
  let marked = "";
  const mark = () => {
    const now = [...cursor.at, player.gate].join(" ");
    if (now === marked) return;
    marked = now;
    const [mesh, samples] = [surfaces.endo[player.gate], polar.samples[player.gate]];
    const near = mesh && samples && painter.segmentNear(cursor.at, player.gate) > 0;
    const sample = near ? sampleNear(samples, mesh, grid, cursor.at) : -1;
    view.markCursor(sample < 0 ? null : placeOnMap(polar, sample));
  };
  cursor.listen(mark);
  player.listen(mark);
}

/** The moments of the beat that stand for it: relaxed and contracted, or the only one. */
function momentsOf({ ed_gate, es_gate }: Results): { name: string; gate: number }[] {
  if (ed_gate === null || es_gate === null) return [{ name: "", gate: 0 }];
  return [
    { name: say("end diastole"), gate: ed_gate - 1 },
    { name: say("end systole"), gate: es_gate - 1 },
  ];
}

function buildSplash(painter: Painter | null, results: Results, point: (segment: number) => void): Splash | null {
  if (!painter || painter.walls.length === 0) {
    byId("splash-panel").remove();
    return null;
  }
  return new Splash(byId("splash"), painter, momentsOf(results), 8, point);
}

function buildResiduals({ fit, pictures }: Report, walls: Wall[], player: Player, cursor: Cursor | null): void {
  if (!fit || !pictures || !cursor) {
    byId("residuals-panel").remove();
    return;
  }
  const residuals = new Residuals(byId("residuals"), fit, walls, pictures.grid, cursor);
  player.listen(() => {
    if (player.gate === residuals.gate) return;
    residuals.gate = player.gate;
    residuals.draw();
  });
}

/** How the meshes came to rest, where the run kept it. */
function buildMotion({ motion, pictures }: Report): MotionView | null {
  if (!motion || !pictures) {
    byId("motion-panel").remove();
    return null;
  }
  byId("motion-title").textContent = say("Motion of the meshes, gate {gate}", { gate: motion.gate + 1 });
  byId("motion-legend").replaceChildren(
    legendItem(say("moving"), "#f2f4f8"),
    legendItem(say("stopped, endo"), colour.endo),
    legendItem(say("stopped, epi"), colour.epi),
    legendItem(say("force of the field"), colour.lit, "line"),
  );
  try {
    return new MotionView(byId("motion"), motion, pictures.grid);
  } catch {
    message(byId("motion"), say("3D needs WebGL"), say("This browser offers none."));
    return null;
  }
}

/** The field that the meshes moved in, where the run kept it. */
function buildField({ motion, pictures }: Report, walls: Wall[], cursor: Cursor | null, moving: MotionView | null): FieldView | null {
  if (!motion || !pictures || !cursor || !wall_names.some((name) => motion[name]?.around)) {
    byId("field-panel").remove();
    return null;
  }
  byId("field-title").textContent = say("Field of the borders, gate {gate}", { gate: motion.gate + 1 });
  byId("field-legend").replaceChildren(
    legendItem(say("endo border"), colour.endo, "square"),
    legendItem(say("epi border"), colour.epi, "square"),
    html("span", {}, say("arrows: direction, their colour: length")),
    legendItem(say("ways of the particles that end in the plane"), "#dfe6ee", "line"),
    legendItem(say("line of the charts"), "#ff7ac8", "line"),
  );
  const field = new FieldView(byId("field"), motion, pictures, walls, cursor);
  moving?.listen((step) => field.seek(step));
  return field;
}

/** The contours of the slices, where the surfaces were made of them. */
function buildContours({ contours, pictures }: Report, walls: Wall[], cursor: Cursor | null): void {
  if (!contours || !pictures || !cursor) {
    byId("contours-panel").remove();
    return;
  }
  byId("contours-title").textContent = say("Contours, gate {gate}", { gate: contours.gate + 1 });
  byId("contours-legend").replaceChildren(
    legendItem(say("endo"), colour.endo),
    legendItem(say("epi"), colour.epi),
    legendItem(say("start, from the slice before"), "#dfe6ee", "line"),
    legendItem(say("pull of the field"), colour.lit, "line"),
    legendItem(say("bending force"), "#ff7ac8", "line"),
  );
  new ContourView(byId("contours"), contours, pictures, walls, cursor);
}

/** Shown while printing, in place of all that is for the screen; built once, when paper is asked for. */
function buildPrinting(report: Report, painter: Painter | null, walls: Wall[], scene: SurfaceScene | null, player: Player): void {
  const show = () => {
    player.pause();
    document.documentElement.dataset.paper = "true";
    buildPaper(byId("paper"), { report, painter, walls, scene, moments: momentsOf(report.results) });
  };
  const hide = () => {
    delete document.documentElement.dataset.paper;
    byId("paper").replaceChildren();
    scene?.show(player.phase);
  };
  if (location.hash === "#print") {
    show();
    document.title += ", printed"; // tells whoever printed that all was drawn
    return;
  }
  addEventListener("beforeprint", show);
  addEventListener("afterprint", hide);
}

async function start(): Promise<void> {
  words.translate(document);
  const toggleTheme = buildTheme(byId("theme"));
  const report = await readReport(byId("data").textContent ?? "");
  const { results, surfaces, pictures, polar } = report;
  byId("subject").textContent = subjectOf(results);
  showVerdict(byId("verdict"), results);
  showCards(byId("numbers"), results);
  showNotes(byId("notes"), results.notes);
  showProvenance(byId("provenance"), results);
  showOptions(byId("options"), results);
  showReadings(byId("readings"), results);
  if (isCorrected(results)) byId("gates-title").textContent = say("Gates, edge surfaces");
  const markGate = showGates(byId("gates"), results);
  // Without a graphics card a browser takes seconds to start WebGL: it shows the numbers before.
  if (location.hash !== "#print") await new Promise((done) => setTimeout(done, 50));

  const walls = surfaces ? wall_names.map((name) => new Wall(name, surfaces)).filter((wall) => wall.present) : [];
  const painter = pictures && new Painter(pictures, walls, polar);
  const player = buildTransport(results);
  player.listen(() => markGate(player.gate));
  const scene = buildScene(report, walls, player);

  // One segment is lit at a time, in every part that shows segments.
  const lights: ((segment: number) => void)[] = [];
  let lit = 0;
  const point = (segment: number) => {
    if (segment === lit) return;
    lit = segment;
    for (const light of lights) light(segment);
  };
  const cursor = painter && cursorOf(painter);
  const view = buildPolar(report, scene, player, cursor, point);
  if (view) scene?.followPointer(point);
  buildCurve(results, walls, player);
  const splash = buildSplash(painter, results, point);
  const slices = buildSlices(painter, cursor, isCorrected(results), player, point);
  buildResiduals(report, walls, player, cursor);
  const field = buildField(report, walls, cursor, buildMotion(report));
  buildContours(report, walls, cursor);
  if (cursor && painter) linkCursor(cursor, report, painter, player, scene, view);
  for (const part of [view, scene, splash, slices]) if (part) lights.push((segment) => part.light(segment));

  const hand = buildHand(painter, slices, results, player);
  joinHost(hand, painter, slices, field, player);
  shareBeat(player);
  buildFilm(results, player, scene);
  const toggles: Record<string, () => void> = { ...(hand ? { h: () => byId("toggle-hand").click() } : {}), ...buildToggles(painter, slices, scene), ...buildLayouts(), l: toggleTheme };
  buildKeys(player, slices, scene, toggles, buildHelp());
  // Two panels with nothing in them must not push the slices off the screen.
  document.querySelector("main")!.classList.toggle("bare", walls.length === 0);
  // Without borders the edges are what explains the failure.
  if (walls.length === 0) toggles.e?.();
  buildPrinting(report, painter, walls, scene, player);
  const still = location.hash === "#print" || matchMedia("(prefers-reduced-motion: reduce)").matches;
  if (walls.length > 0 && !still) player.play();
  document.documentElement.dataset.ready = "true";
}

start().catch((error: unknown) => {
  const place = byId("verdict");
  place.classList.add("fail");
  place.replaceChildren(
    html("div", {}, html("h1", {}, say("This report cannot be shown")), html("p", {}, `${String(error)}. ${say("The numbers are in results.json and results.csv beside it.")}`)),
  );
});
