// What a person says in place of what was found, on the planes of the slices: handles for the centre, the long axis, the
// circle, the ends of the heart and the valve plane; points of the borders; a brush for what is no heart; gates to leave
// out. The values are the options `manual.*` of the program and a mask.
import { borderDrag, type BorderPoint, type Drag, drawPoint, numbersOf, pointsIn, pointsOn } from "./borderpoints";
import { copyText } from "./clipboard";
import { toWorld, type Voxel } from "./cursor";
import { toVoxels, walls as wall_names, type Results } from "./data";
import { figure, html, saveFile } from "./dom";
import { argumentsOf, type ByHand, maskFile, mask_name, onGrid, type Paint, quoted, type Tell } from "./host";
import { brushOver, drawPaint } from "./paint";
import { voxelIn, type Drawing, type Painter, type Plane } from "./painter";
import { fields, type Key, manualOf, rounded, roundedOf, type Said, saidFrom, saidIn, valueOf } from "./said";
import type { Tool } from "./slices";
import { say } from "./words";

type Mode = "move" | "border" | "paint" | "erase";
type Point = [number, number];

const reach_px = 9;
const most_undo = 30;
/** The program's circle leaves so much room around the wall's middle. */
const room_mm = 22;
const ink = { found: "#e8edf3", changed: "#ffe14d" } as const;

export class HandTool implements Tool {
  on = false;
  gate = 0;
  private mode: Mode = "move";
  private brush_mm = 8;
  private said: Said;
  /** What this report was made with. */
  private readonly used: Said;
  private used_paint: Paint | null = null;
  private paint: Uint8Array | null = null;
  private before: { said: Said; paint: Uint8Array | null }[] = [];
  private drag: Drag | null = null;
  private readonly found: Required<Pick<Said, "center_mm" | "axis" | "radius_mm" | "first_slice" | "last_slice">>;
  private readonly half_mm: number;
  private readonly inputs = new Map<Key, HTMLInputElement>();
  private readonly buttons = new Map<string, HTMLButtonElement>();
  private readonly state = html("p", { class: "hand-state", role: "status" });

  /** Runs the study again with what is said, or only hears it; null: nobody can, and the command line is offered. */
  private host: Tell | null = null;
  private at_once = false;
  private told = 0;

  constructor(
    private readonly place: HTMLElement,
    private readonly painter: Painter,
    private readonly results: Results,
    private readonly redraw: () => void,
  ) {
    this.used = saidIn(manualOf(results));
    this.said = structuredClone(this.used);
    const { grid, heart } = painter;
    const middle: Voxel = [...painter.middle, (heart.z0 + heart.z1) / 2];
    const found = results.heart;
    this.found = {
      center_mm: found?.center_mm ?? toWorld(grid, middle),
      axis: found?.axis ?? [grid.direction[2]!, grid.direction[5]!, grid.direction[8]!],
      radius_mm: (found?.radius_mm ?? 30) + room_mm,
      first_slice: 1,
      last_slice: grid.dims[2],
    };
    const high = painter.walls.flatMap(({ meshes }) => meshes.flatMap((mesh) => (mesh ? [...mesh.voxel].filter((_, n) => n % 3 === 2) : [])));
    if (high.length > 0) {
      const [low, top] = high.reduce(([a, b], z) => [Math.min(a, z), Math.max(b, z)], [Infinity, -Infinity] as Point);
      this.found.first_slice = Math.max(Math.floor(low) + 1, 1);
      this.found.last_slice = Math.min(Math.ceil(top) + 1, grid.dims[2]);
    }
    this.half_mm = 0.5 * (heart.z1 - heart.z0) * grid.spacing_mm[2];
    this.build();
  }

  /** A page around the report takes what is said, and has what was said before. */
  serve(host: Tell, given: ByHand, at_once: boolean): void {
    const is_first = this.host === null;
    this.host = host;
    if (is_first && given.paint) {
      this.used_paint = given.paint;
      this.paint = onGrid(given.paint, this.painter.grid);
    }
    this.at_once = at_once;
    // What is said elsewhere in the page, and not yet here.
    if (JSON.stringify(given.options) !== JSON.stringify(this.byHand().options)) {
      if (!is_first) this.keep();
      this.said = saidFrom(given.options);
    }
    for (const id of ["run", "at-once"]) this.buttons.get(id)!.hidden = false;
    this.refresh();
  }

  /** The page around the report hears of changes once a picture: a pointer moves more often. */
  private tell(): void {
    if (!this.host || this.told) return;
    this.told = requestAnimationFrame(() => {
      this.told = 0;
      this.host?.(this.byHand(), false, this.gate + 1, this.at_once);
    });
  }

  private run(): void {
    this.host?.(this.byHand(), true, this.gate + 1, this.at_once);
  }

  /** A change is made: a handle is released, a value typed. */
  private changed(): void {
    this.refresh();
    if (this.at_once && this.is_changed) this.run();
  }

  toggle(): void {
    this.on = !this.on;
    this.place.hidden = !this.on;
    this.refresh();
  }

  // ---- What is said ----

  private get<K extends keyof HandTool["found"]>(key: K): NonNullable<Said[K]> {
    return (this.said[key] ?? this.found[key]) as NonNullable<Said[K]>;
  }

  private keep(): void {
    this.before.push({ said: structuredClone(this.said), paint: this.paint?.slice() ?? null });
    if (this.before.length > most_undo) this.before.shift();
  }

  private set<K extends Key>(key: K, value: Said[K] | undefined): void {
    if (value === undefined) delete this.said[key];
    else this.said[key] = value;
    this.refresh();
  }

  undo(): void {
    const last = this.before.pop();
    if (!last) return;
    this.said = last.said;
    this.paint = last.paint;
    this.changed();
  }

  private get is_painted(): boolean {
    return this.paint !== null && this.paint.includes(1);
  }

  byHand(): ByHand {
    const options: Record<string, string> = {};
    for (const { key } of fields) {
      const value = this.said[key];
      if (value === undefined) continue;
      options[`manual.${key}`] = Array.isArray(value) ? value.map(roundedOf(key)).join(",") : typeof value === "number" ? String(rounded(value)) : value;
    }
    if (this.said.decision) options["manual.decision"] = this.said.decision;
    return { options, paint: this.is_painted ? { grid: this.painter.grid, voxels: this.paint! } : null };
  }

  private get is_changed(): boolean {
    const paint = this.used_paint && onGrid(this.used_paint, this.painter.grid);
    const same_paint = this.is_painted === (paint?.includes(1) ?? false) && (!this.is_painted || this.paint!.every((v, n) => v === paint![n]));
    return !same_paint || JSON.stringify(saidIn({ ...this.said })) !== JSON.stringify(saidIn({ ...this.used }));
  }

  /** Where the valve plane of the gate crosses the stack, in slices from 0; null: none was found. */
  private base(): number | null {
    const plane = this.results.gates[this.gate]?.base_plane;
    if (!plane) return null;
    const at = toVoxels(this.painter.grid, new Float32Array(plane.point_mm))[2]!;
    return at + ((this.said.base_shift_mm ?? 0) - (this.used.base_shift_mm ?? 0)) / this.painter.grid.spacing_mm[2];
  }

  /** The centre and the two ends of the axis, in voxels. */
  private line(): { centre: Voxel; ends: [Voxel, Voxel] } {
    const { grid } = this.painter;
    const centre_mm = this.get("center_mm");
    const axis = this.get("axis");
    const length = Math.hypot(...axis) || 1;
    const voxel = (mm: number) => [...toVoxels(grid, new Float32Array(centre_mm.map((c, n) => c + (mm * axis[n]!) / length)))] as Voxel;
    return { centre: voxel(0), ends: [voxel(-this.half_mm), voxel(this.half_mm)] };
  }

  // ---- Handles ----

  over(plane: Plane, at: number): Drawing | undefined {
    if (!this.on) return undefined;
    return (context, pixel) => this.draw(context, pixel, plane, at);
  }

  private draw(context: CanvasRenderingContext2D, pixel: number, plane: Plane, at: number): void {
    const { grid } = this.painter;
    const spacing = grid.spacing_mm;
    const tint = (key: Key) => (this.said[key] === undefined ? ink.found : ink.changed);
    if (this.paint) drawPaint(context, this.paint, grid, plane, at);
    const stroke = (colour: string, path: () => void, dash: number[] = []) => {
      for (const [width, style] of [[4, "rgba(0, 0, 0, 0.6)"], [1.8, colour]] as const) {
        context.lineWidth = width * pixel;
        context.strokeStyle = style;
        context.setLineDash(dash.map((d) => d * pixel));
        context.beginPath();
        path();
        context.stroke();
      }
      context.setLineDash([]);
    };
    // A voxel is as high as it is wide in mm alone.
    const flat = spacing[plane.x]! / spacing[plane.y]!;
    const dot = (x: number, y: number, colour: string) => {
      context.beginPath();
      context.ellipse(x, y, 6 * pixel, 6 * pixel * flat, 0, 0, 2 * Math.PI);
      context.fillStyle = colour;
      context.fill();
      context.lineWidth = 1.5 * pixel;
      context.strokeStyle = "#000";
      context.stroke();
    };
    const { centre, ends } = this.line();
    if (plane.axis === 2) {
      const r = this.get("radius_mm");
      stroke(tint("radius_mm"), () => context.ellipse(centre[0], centre[1], r / spacing[0], r / spacing[1], 0, 0, 2 * Math.PI), [6, 4]);
    } else {
      const frame = this.painter.frameOf(plane);
      const level = (y: number, key: Key, name: string, dash: number[]) => {
        stroke(tint(key), () => (context.moveTo(frame.x0, y), context.lineTo(frame.x1, y)), dash);
        const to = context.getTransform().transformPoint({ x: frame.x0, y });
        context.save();
        context.resetTransform();
        const ratio = Math.min(devicePixelRatio, 2);
        context.font = `600 ${11 * ratio}px system-ui, sans-serif`;
        context.textAlign = "left";
        context.textBaseline = "alphabetic";
        context.fillStyle = tint(key);
        context.shadowColor = "#000";
        context.shadowBlur = 3 * ratio;
        context.fillText(name, Math.max(to.x, 0) + 6 * ratio, to.y - 4 * ratio);
        context.restore();
      };
      level(this.get("first_slice") - 1.5, "first_slice", say("first slice"), [2, 4]);
      level(this.get("last_slice") - 0.5, "last_slice", say("last slice"), [2, 4]);
      const base = this.base();
      if (base !== null) level(base, "base_shift_mm", say("valve plane"), []);
      stroke(tint("axis"), () => (context.moveTo(ends[0][plane.x]!, ends[0][plane.y]!), context.lineTo(ends[1][plane.x]!, ends[1][plane.y]!)));
      for (const end of ends) dot(end[plane.x]!, end[plane.y]!, tint("axis"));
    }
    dot(centre[plane.x]!, centre[plane.y]!, tint("center_mm"));
    for (const { point, place } of pointsOn(grid, this.points, { plane, at, gate: this.gate })) drawPoint(context, place, point.wall, pixel, flat);
  }

  /** What a pointer would take at a place of a plane; `mm`: of a pixel of the page. */
  private handleAt(plane: Plane, [x, y]: Point, mm: number): ((place: Point) => void) | null {
    const spacing = this.painter.grid.spacing_mm;
    const reach = reach_px * mm;
    const far = (to: Voxel) => Math.hypot((to[plane.x]! - x) * spacing[plane.x]!, (to[plane.y]! - y) * spacing[plane.y]!);
    const { centre, ends } = this.line();
    if (far(centre) < reach) return (to) => this.moveCentre(plane, to);
    if (plane.axis === 2) return Math.abs(far(centre) - this.get("radius_mm")) < reach ? (to) => this.moveCircle(to) : null;
    const end = ends.findIndex((place) => far(place) < reach);
    if (end >= 0) return (to) => this.turn(plane, to, end === 0 ? -1 : 1);
    const near = (level: number) => Math.abs(level - y) * spacing[2] < reach;
    const base = this.base();
    if (base !== null && near(base)) {
      const start = base - (this.said.base_shift_mm ?? 0) / spacing[2];
      return ([, to]) => this.set("base_shift_mm", rounded((to - start) * spacing[2]));
    }
    const slice = (to: number) => Math.min(Math.max(Math.round(to), 1), this.painter.grid.dims[2]);
    if (near(this.get("first_slice") - 1.5)) return ([, to]) => this.set("first_slice", Math.min(slice(to + 1.5), this.get("last_slice")));
    if (near(this.get("last_slice") - 0.5)) return ([, to]) => this.set("last_slice", Math.max(slice(to + 0.5), this.get("first_slice")));
    return null;
  }

  private get points(): BorderPoint[] {
    return [...pointsIn(this.said.endo_points ?? [], "endo"), ...pointsIn(this.said.epi_points ?? [], "epi")];
  }

  private setPoints(points: BorderPoint[]): void {
    for (const wall of wall_names) {
      const numbers = numbersOf(points, wall).map(rounded);
      this.set(`${wall}_points`, numbers.length > 0 ? numbers : undefined);
    }
  }

  private moveCentre(plane: Plane, [x, y]: Point): void {
    const { dims } = this.painter.grid;
    const voxel = this.line().centre;
    voxel[plane.x] = Math.min(Math.max(x, 0), dims[plane.x]! - 1);
    voxel[plane.y] = Math.min(Math.max(y, 0), dims[plane.y]! - 1);
    this.set("center_mm", toWorld(this.painter.grid, voxel).map(rounded) as Voxel);
  }

  private moveCircle([x, y]: Point): void {
    const { spacing_mm } = this.painter.grid;
    const { centre } = this.line();
    const r = Math.hypot((x - centre[0]) * spacing_mm[0], (y - centre[1]) * spacing_mm[1]);
    this.set("radius_mm", rounded(Math.min(Math.max(r, 5), 200)));
  }

  /** Turns the axis in the plane, so that one of its ends points to a place. */
  private turn(plane: Plane, [x, y]: Point, sign: 1 | -1): void {
    const { grid } = this.painter;
    const { centre, ends } = this.line();
    const mm = ends[1].map((e, n) => (e - ends[0][n]!) * grid.spacing_mm[n]!) as Voxel;
    const way: Point = [sign * (x - centre[plane.x]!) * grid.spacing_mm[plane.x]!, sign * (y - centre[plane.y]!) * grid.spacing_mm[plane.y]!];
    if (way[1] < 1) return; // an axis that lies in the slices is none
    const along = mm[2];
    mm[plane.x] = (way[0] / way[1]) * along;
    const world = [0, 1, 2].map((row) => [0, 1, 2].reduce((sum, n) => sum + grid.direction[3 * row + n]! * mm[n]!, 0)) as Voxel;
    const length = Math.hypot(...world);
    this.set("axis", world.map((v) => Math.round((v / length) * 1e4) / 1e4) as Voxel);
  }

  private brush(plane: Plane, at: number, place: Point): void {
    const { grid } = this.painter;
    this.paint ??= new Uint8Array(grid.dims[0] * grid.dims[1] * grid.dims[2]);
    brushOver(this.paint, grid, voxelIn(plane, at, place), this.brush_mm, this.mode === "paint");
    this.refresh();
  }

  private dragAt(plane: Plane, at: number, place: Point, mm: number): Drag | null {
    if (this.mode === "border")
      return borderDrag(this.painter, this.points, { plane, at, gate: this.gate }, place, reach_px * mm, (points) => this.setPoints(points));
    const move = this.mode === "move" ? this.handleAt(plane, place, mm) : (to: Point) => this.brush(plane, at, to);
    return move && { move };
  }

  down(plane: Plane, at: number, place: Point, mm: number): boolean {
    if (!this.on) return false;
    this.drag = this.dragAt(plane, at, place, mm);
    if (!this.drag) return false;
    this.keep();
    if (this.mode === "paint" || this.mode === "erase") this.drag.move(place);
    return true;
  }

  move(place: Point): void {
    if (!this.drag) return;
    this.drag.has_moved = true;
    this.drag.move(place);
  }

  up(): void {
    if (!this.drag) return;
    if (!this.drag.has_moved) this.drag.still?.();
    this.drag = null;
    this.changed();
  }

  pointer(plane: Plane, at: number, place: Point, mm: number): string {
    if (!this.on) return "";
    if (this.mode === "paint" || this.mode === "erase") return "cell";
    return this.dragAt(plane, at, place, mm) ? "grab" : "";
  }

  // ---- The bar ----

  private button(id: string, name: string, work: () => void, title = ""): HTMLButtonElement {
    const button = html("button", { type: "button", id: `hand-${id}`, title }, name);
    button.addEventListener("click", work);
    this.buttons.set(id, button);
    return button;
  }

  private build(): void {
    const modes: [Mode, string, string][] = [
      ["move", say("Move handles"), say("Drag the centre, the ends of the axis, the circle, the lines")],
      ["border", say("Move a border"), say("Drag a border of this gate to where it is: the next fit goes through that point. Click a point to take it back")],
      ["paint", say("Paint out"), say("What is painted is not looked at, in no gate")],
      ["erase", say("Erase"), say("Takes paint away")],
    ];
    const brush = html("input", { type: "range", min: 3, max: 30, step: 1, value: this.brush_mm, "aria-label": say("Radius of the brush, mm") });
    brush.addEventListener("input", () => (this.brush_mm = brush.valueAsNumber));
    const run = this.button("run", say("Run again with this"), () => this.run());
    run.classList.add("primary");
    const at_once = this.button("at-once", say("At once"), () => ((this.at_once = !this.at_once), this.changed()), say("Run again after every change"));
    run.hidden = at_once.hidden = true;
    this.place.replaceChildren(
      html("div", { class: "motion-bar" },
        ...modes.map(([mode, name, title]) => this.button(mode, name, () => ((this.mode = mode), this.refresh()), title)),
        html("label", { class: "select" }, `${say("Brush")} `, brush),
        this.button("exclude", "", () => this.toggleGate()),
        this.button("undo", say("Undo"), () => this.undo(), say("Ctrl + Z")),
        this.button("reset", say("Reset"), () => (this.keep(), (this.said = {}), (this.paint = null), this.changed()), say("As the program found it")),
        run,
        at_once,
        this.button("copy", say("Copy as command line"), () => this.copy()),
        this.button("mask", say("Save the mask"), () => this.saveMask()),
      ),
      html("div", { class: "hand-fields" }, ...fields.filter(({ is_text }) => !is_text).map((field) => this.field(field))),
      html("div", { class: "hand-fields texts" },
        this.button("accepted", say("Accept"), () => this.decide("accepted"), say("Record that a reader accepts the result")),
        this.button("rejected", say("Reject"), () => this.decide("rejected"), say("Record that a reader rejects the result")),
        ...fields.filter(({ is_text }) => is_text).map((field) => this.field(field)),
      ),
      this.state,
    );
    this.refresh();
  }

  private field({ key, name, title }: (typeof fields)[number]): HTMLElement {
    const input = html("input", { type: "text", id: `hand-${key}`, title, autocomplete: "off", spellcheck: "false", maxlength: key.endsWith("_points") ? "20000" : "300" });
    input.addEventListener("change", () => {
      let value: Said[Key] | undefined;
      let expected = "";
      try {
        value = valueOf(key, input.value);
      } catch (error) {
        expected = (error as RangeError).message;
      }
      input.setCustomValidity(expected);
      if (!input.reportValidity()) return;
      this.keep();
      this.set(key, value);
      this.changed();
    });
    this.inputs.set(key, input);
    return html("label", {}, html("span", {}, name), input);
  }

  private decide(decision: "accepted" | "rejected"): void {
    this.keep();
    this.set("decision", this.said.decision === decision ? undefined : decision);
    this.refresh();
  }

  private toggleGate(): void {
    this.keep();
    const gate = this.gate + 1;
    const gates = this.said.exclude_gates ?? [];
    const now = gates.includes(gate) ? gates.filter((g) => g !== gate) : [...gates, gate].sort((a, b) => a - b);
    this.set("exclude_gates", now.length > 0 ? now : undefined);
    this.changed();
  }

  commandLine(): string {
    const plain = this.results.provenance.command.replace(/ --set (?:'manual\.(?:[^']|'\\'')*'|manual\.\S*)/g, "").replace(/ --mask \S+/, "");
    return [plain, ...argumentsOf(this.byHand()).map(quoted)].join(" ");
  }

  private copy(): void {
    const button = this.buttons.get("copy")!;
    copyText(this.commandLine(), this.place);
    button.textContent = say("Copied");
    button.dataset.copied = this.commandLine();
    setTimeout(() => (button.textContent = say("Copy as command line")), 1500);
  }

  private saveMask(): void {
    const { paint } = this.byHand();
    if (paint) saveFile(new Blob([maskFile(paint) as BlobPart]), mask_name);
  }

  /** After every change. */
  refresh(): void {
    for (const mode of ["move", "border", "paint", "erase"]) this.buttons.get(mode)!.setAttribute("aria-pressed", String(mode === this.mode));
    for (const { key } of fields) {
      const input = this.inputs.get(key)!;
      const value = this.said[key];
      const found = key in this.found ? this.found[key as keyof HandTool["found"]] : key === "base_shift_mm" ? 0 : key === "exclude_gates" ? say("none") : "";
      const shown = (v: unknown) => (Array.isArray(v) ? v.map((x: number) => roundedOf(key)(x)).join(",") : typeof v === "number" ? String(rounded(v)) : String(v));
      input.placeholder = shown(found);
      if (document.activeElement !== input || value === undefined) input.value = value === undefined ? "" : shown(value);
      input.classList.toggle("changed", value !== undefined);
    }
    for (const decision of ["accepted", "rejected"]) this.buttons.get(decision)!.setAttribute("aria-pressed", String(this.said.decision === decision));
    const out = this.said.exclude_gates?.includes(this.gate + 1);
    const exclude = this.buttons.get("exclude")!;
    exclude.textContent = out ? say("Include gate {gate}", { gate: this.gate + 1 }) : say("Exclude gate {gate}", { gate: this.gate + 1 });
    exclude.disabled = this.results.gates.length < 2;
    this.buttons.get("undo")!.disabled = this.before.length === 0;
    const { options, paint } = this.byHand();
    const count = Object.keys(options).length + (paint ? 1 : 0);
    this.buttons.get("reset")!.disabled = count === 0;
    this.buttons.get("copy")!.hidden = this.host !== null;
    this.buttons.get("mask")!.style.visibility = paint ? "" : "hidden"; // its place is kept: the slices stay under the brush
    const run = this.buttons.get("run")!;
    run.disabled = !this.is_changed;
    this.buttons.get("at-once")!.setAttribute("aria-pressed", String(this.at_once));
    this.tellState();
    this.redraw();
    this.tell();
  }

  private tellState(): void {
    const { options, paint } = this.byHand();
    const count = Object.keys(options).length + (paint ? 1 : 0);
    const painted = paint ? paint.voxels.reduce((sum, v) => sum + v, 0) : 0;
    const volume = (painted * this.painter.grid.spacing_mm.reduce((a, b) => a * b, 1)) / 1000;
    this.state.textContent = [
      count === 0 ? say("Nothing is changed. Drag a handle, type a value or paint.") : say("{n} changed by hand", { n: count }),
      paint ? say("{ml} mL painted out", { ml: figure(volume, 0) }) : "",
      this.is_changed ? (this.host ? say("the numbers above are without it until you run again") : say("run the command line to see what it changes")) : "",
    ].filter(Boolean).join(" · ");
  }
}
