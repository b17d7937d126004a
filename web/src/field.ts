// The field that pulls the particles, on any plane: arrows, the ways of the particles, the mesh at a step of its motion,
// and what the field has along a line that is drawn.
import { eachVoxel, vectorAt } from "./around";
import type { Cursor, Voxel } from "./cursor";
import { section, type Wall } from "./cycle";
import { toVoxels, walls, type Around, type Grid, type Motion, type Preview, type WallName, type Way } from "./data";
import { colour, figure, html } from "./dom";
import { keptAt } from "./motion";
import { Painter, Plane } from "./painter";
import { chartCanvas } from "./pen";
import { evenColour } from "./polar";
import { say, wall_words } from "./words";

type Point = [number, number];
const ink = { way: "#dfe6ee", line: "#ff7ac8", meet: "#ff964f", along: "#4ac06e" } as const;
const samples = 160;
const planes = [
  { name: say("Short axis"), plane: new Plane(2) },
  { name: say("Cut along rows"), plane: new Plane(1) },
  { name: say("Cut along columns"), plane: new Plane(0) },
] as const;
/** Arrows stand at least so many pixels apart. */
const apart_px = 11;

const shown_names = { arrows: say("Arrows"), ways: say("Ways of the particles"), mesh: say("Mesh"), border: say("Border voxels") } as const;
type Shown = keyof typeof shown_names;

/** What the field has along a line. */
interface Profile {
  mm: number[];
  length: number[];
  along: number[];
  image: number[];
  /** Where vectors from both sides meet, mm from the line's beginning. */
  meetings: number[];
}

export class FieldView {
  private readonly ways: { name: WallName; way: Way; around: Around }[];
  private chosen: { name: WallName; way: Way; around: Around };
  private plane: Plane = planes[0].plane;
  private step = 0;
  /** Null: the row of pixels through the cursor. */
  private line: [Point, Point] | null = null;
  /** As the fields would be with what a person says; null: nothing is changed. */
  private preview_: Preview | null = null;
  private readonly painter: Painter;
  private readonly canvas = html("canvas", { class: "field-plane", role: "img" });
  private readonly scale = html("p", { class: "field-scale" });
  private readonly caption = html("p", { class: "caption", "aria-live": "polite" });
  private readonly lengths = chartCanvas(
    say("Length of the field along the line, 1/mm; the image in grey"),
    say("Length of the field along the line"),
  );
  private readonly parts = chartCanvas(
    say("Its part along the line, 1/mm; it meets where it falls through 0"),
    say("Part of the field along the line"),
  );
  private readonly row: HTMLInputElement;
  private readonly shows: Record<Shown, boolean> = { arrows: true, ways: true, mesh: true, border: true };

  constructor(
    place: HTMLElement,
    private readonly motion: Motion,
    pictures: Painter["pictures"],
    surfaces: Wall[],
    private readonly cursor: Cursor,
  ) {
    this.ways = walls.flatMap((name) => (motion[name]?.around ? [{ name, way: motion[name], around: motion[name].around }] : []));
    this.chosen = this.ways.at(-1)!;
    this.painter = new Painter(pictures, surfaces, null);
    this.painter.overlay = { contours: false, sections: false, edges: false, whole: false, brightness: 1 };
    this.row = html("input", { type: "range", min: 1, max: 1, step: 1, "aria-label": say("Row of the line") });
    this.row.addEventListener("input", () => {
      const to: Voxel = [...cursor.at];
      to[this.plane.y] = this.row.valueAsNumber - 1;
      this.line = null;
      cursor.move(to);
      this.draw();
    });
    place.replaceChildren(
      this.bar(),
      html("div", { class: "field-body" }, html("div", {}, this.canvas, this.scale), html("div", { class: "particle-charts" }, this.lengths.figure, this.parts.figure, this.caption)),
    );
    this.followPointer();
    new ResizeObserver(() => this.draw()).observe(place);
    cursor.listen(() => this.draw());
  }

  /** Shows the mesh as it was at a step of the motion. */
  seek(step: number): void {
    this.step = step;
    this.draw();
  }

  /** Shows the field of another border in the place of its own. */
  preview(preview: Preview | null): void {
    const before = this.preview_;
    this.preview_ = preview?.gate === this.motion.gate ? preview : null;
    if (before !== this.preview_) this.draw();
  }

  private get around(): Around {
    return this.preview_?.[this.chosen.name] ?? this.chosen.around;
  }

  private get grid(): Grid {
    return this.painter.grid;
  }

  private bar(): HTMLElement {
    const select = (label: string, names: string[], at: number, choose: (n: number) => void) => {
      const box = html("select", { "aria-label": label }, ...names.map((name, n) => html("option", { selected: n === at }, name)));
      box.addEventListener("change", () => {
        choose(box.selectedIndex);
        this.line = null;
        this.draw();
      });
      return html("label", { class: "select" }, `${label} `, box);
    };
    const toggles = (Object.keys(shown_names) as Shown[]).map((key) => {
      const box = html("input", { type: "checkbox", checked: true });
      box.addEventListener("change", () => {
        this.shows[key] = box.checked;
        this.draw();
      });
      return html("label", { class: "select" }, box, " ", shown_names[key]);
    });
    return html(
      "div",
      { class: "motion-bar" },
      select(say("Border"), this.ways.map(({ name }) => wall_words[name]), this.ways.length - 1, (n) => (this.chosen = this.ways[n]!)),
      select(say("Plane"), planes.map(({ name }) => name), 0, (n) => (this.plane = planes[n]!.plane)),
      ...toggles,
      html("label", { class: "select" }, `${say("Line")} `, this.row),
    );
  }

  /** A click moves the cursor, and the line with it; a drag draws another line. */
  private followPointer(): void {
    let from: Point | null = null;
    const at = (event: PointerEvent) => this.painter.voxelAt(this.plane, this.canvas, event);
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      from = at(event);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from || !(event.buttons & 1)) return;
      const to = at(event);
      if (to[0] === from[0] && to[1] === from[1]) return;
      this.line = [from, to];
      this.draw();
    });
    this.canvas.addEventListener("pointerup", (event) => {
      const to = at(event);
      if (from && to[0] === from[0] && to[1] === from[1]) {
        const voxel: Voxel = [...this.cursor.at];
        voxel[this.plane.x] = to[0];
        voxel[this.plane.y] = to[1];
        this.line = null;
        this.cursor.move(voxel);
        this.draw();
      }
      from = null;
    });
  }

  /** The voxel of a point of the plane. */
  private voxelOf([x, y]: Point): Voxel {
    const voxel: Voxel = [0, 0, 0];
    voxel[this.plane.axis] = this.cursor.at[this.plane.axis]!;
    voxel[this.plane.x] = x;
    voxel[this.plane.y] = y;
    return voxel;
  }

  private shownLine(): [Point, Point] {
    if (this.line) return this.line;
    const frame = this.painter.frameOf(this.plane);
    const y = this.cursor.at[this.plane.y]!;
    return [[Math.ceil(frame.x0), y], [Math.floor(frame.x1), y]];
  }

  private profile(): Profile {
    const [a, b] = this.shownLine();
    const { spacing_mm } = this.grid;
    const { pictures } = this.painter;
    const mm = [(b[0] - a[0]) * spacing_mm[this.plane.x]!, (b[1] - a[1]) * spacing_mm[this.plane.y]!] as const;
    const total = Math.hypot(...mm) || 1;
    const found: Profile = { mm: [], length: [], along: [], image: [], meetings: [] };
    for (let n = 0; n <= samples; ++n) {
      const share = n / samples;
      const voxel = this.voxelOf([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
      const v = vectorAt(this.around, voxel) ?? [0, 0, 0];
      const along = (v[this.plane.x]! * mm[0] + v[this.plane.y]! * mm[1]) / total;
      const before = found.along.at(-1);
      const at = share * total;
      if (before !== undefined && before > 0 && along <= 0) found.meetings.push(at - (total / samples) * (-along / (before - along)));
      found.mm.push(at);
      found.length.push(Math.hypot(...v));
      found.along.push(along);
      const [i, j, k] = voxel.map((p, axis) => Math.floor(Math.round(p) / (axis < 2 ? pictures.bin : 1))) as Voxel;
      const { columns, rows, grid } = pictures;
      found.image.push(pictures.pixels[i + columns * (j + rows * (k + grid.dims[2] * Math.min(this.motion.gate, pictures.gates - 1)))] ?? 0);
    }
    return found;
  }

  /** The longest vector of the plane that is shown, 1/mm. */
  private longestShown(): number {
    const { axis } = this.plane;
    const { vectors } = this.around;
    let longest = 1e-12;
    eachVoxel(this.around, (voxel, n) => {
      if (voxel[axis] === this.cursor.at[axis]) longest = Math.max(longest, Math.hypot(vectors[3 * n]!, vectors[3 * n + 1]!, vectors[3 * n + 2]!));
    });
    return longest;
  }

  private drawBorder(context: CanvasRenderingContext2D): void {
    const { axis, x, y } = this.plane;
    context.fillStyle = colour[this.chosen.name];
    context.globalAlpha = 0.55;
    eachVoxel(this.around, (voxel, n) => {
      if (voxel[axis] === this.cursor.at[axis] && this.around.border[n] === 1) context.fillRect(voxel[x]! - 0.4, voxel[y]! - 0.4, 0.8, 0.8);
    });
    context.globalAlpha = 1;
  }

  /** Direction by arrow, length by colour. A vector that leaves the plane is drawn as short as it looks from above. */
  private drawArrows(context: CanvasRenderingContext2D, pixel: number, longest: number): void {
    const { axis, x, y } = this.plane;
    const { spacing_mm } = this.grid;
    const stride = Math.max(1, Math.ceil(apart_px * pixel));
    const half = 0.42 * stride * Math.min(spacing_mm[x]!, spacing_mm[y]!);
    const { vectors } = this.around;
    context.lineWidth = 1.3 * pixel;
    eachVoxel(this.around, (voxel, n) => {
      if (voxel[axis] !== this.cursor.at[axis] || voxel[x]! % stride !== 0 || voxel[y]! % stride !== 0) return;
      const v = [vectors[3 * n]!, vectors[3 * n + 1]!, vectors[3 * n + 2]!];
      const length = Math.hypot(...v);
      if (length < 1e-4 * longest) return;
      const way: Point = [(half * v[x]!) / length, (half * v[y]!) / length];
      const at = ([dx, dy]: Point): Point => [voxel[x]! + dx / spacing_mm[x]!, voxel[y]! + dy / spacing_mm[y]!];
      const turned = (angle: number): Point => [
        way[0] + 0.7 * (way[0] * Math.cos(angle) - way[1] * Math.sin(angle)),
        way[1] + 0.7 * (way[0] * Math.sin(angle) + way[1] * Math.cos(angle)),
      ];
      context.strokeStyle = evenColour(length / longest);
      context.beginPath();
      context.moveTo(...at([-way[0], -way[1]]));
      context.lineTo(...at(way));
      for (const side of [-1, 1]) {
        context.moveTo(...at(way));
        context.lineTo(...at(turned(side * 2.6)));
      }
      context.stroke();
    });
  }

  /** The ways of the particles that end near the plane, a dot where each came to rest. */
  private drawWays(context: CanvasRenderingContext2D, pixel: number): void {
    const { way } = this.chosen;
    const { axis, x, y } = this.plane;
    const places = toVoxels(this.grid, way.places);
    const last = way.steps.length - 1;
    const at = (kept: number, v: number) => 3 * (kept * way.particles + v);
    context.strokeStyle = ink.way;
    context.fillStyle = colour[this.chosen.name];
    context.lineWidth = 0.9 * pixel;
    for (let v = 0; v < way.particles; ++v) {
      const end = at(last, v);
      if (Math.abs(places[end + axis]! - this.cursor.at[axis]!) > 0.5) continue;
      context.beginPath();
      for (let kept = 0; kept <= last; ++kept) context.lineTo(places[at(kept, v) + x]!, places[at(kept, v) + y]!);
      context.stroke();
      context.beginPath();
      context.arc(places[end + x]!, places[end + y]!, 2.4 * pixel, 0, 2 * Math.PI);
      context.fill();
    }
  }

  private drawMesh(context: CanvasRenderingContext2D, pixel: number): void {
    const { way, name } = this.chosen;
    const kept = keptAt(way, this.step);
    const places = way.places.subarray(3 * kept * way.particles, 3 * (kept + 1) * way.particles);
    const { lines } = section(toVoxels(this.grid, places), way.triangles, this.plane.axis, this.cursor.at[this.plane.axis]!);
    context.beginPath();
    for (let n = 0; n < lines.length; n += 4) {
      context.moveTo(lines[n]!, lines[n + 1]!);
      context.lineTo(lines[n + 2]!, lines[n + 3]!);
    }
    for (const [width, style] of [[4, "rgba(0, 0, 0, 0.6)"], [2, colour[name]]] as const) {
      context.lineWidth = width * pixel;
      context.strokeStyle = style;
      context.stroke();
    }
  }

  private drawLine(context: CanvasRenderingContext2D, pixel: number): void {
    const [a, b] = this.shownLine();
    context.strokeStyle = ink.line;
    context.lineWidth = 1.6 * pixel;
    context.beginPath();
    context.moveTo(...a);
    context.lineTo(...b);
    context.stroke();
  }

  draw(): void {
    if (this.canvas.clientWidth === 0) return;
    const { plane, cursor, shows } = this;
    const frame = this.painter.frameOf(plane);
    const { spacing_mm } = this.grid;
    this.canvas.style.aspectRatio = String(((frame.x1 - frame.x0) * spacing_mm[plane.x]!) / ((frame.y1 - frame.y0) * spacing_mm[plane.y]!));
    this.row.max = String(this.grid.dims[plane.y]);
    this.row.value = String(cursor.at[plane.y]! + 1);
    const longest = this.longestShown();
    this.painter.paint(this.canvas, {
      plane,
      at: cursor.at[plane.axis]!,
      gate: this.motion.gate,
      segment: 0,
      width: 1,
      letters: true,
      cross: null,
      over: (context, pixel) => {
        if (shows.border) this.drawBorder(context);
        if (shows.arrows) this.drawArrows(context, pixel, longest);
        if (shows.ways) this.drawWays(context, pixel);
        if (shows.mesh) this.drawMesh(context, pixel);
        this.drawLine(context, pixel);
      },
    });
    const n = cursor.at[plane.axis]! + 1;
    const what = plane.axis === 2 ? say("Slice {slice}", { slice: n }) : plane.axis === 1 ? say("Row {n}", { n }) : say("Column {n}", { n });
    const border = this.chosen.name === "endo" ? say("endo border") : say("epi border");
    this.canvas.setAttribute("aria-label", say("Field, {border}, gate {gate}, {what}", { border, gate: this.motion.gate + 1, what }));
    this.scale.replaceChildren("0 ", html("span", { class: "field-colours", role: "img", "aria-label": say("Colours of the lengths") }), ` ${longest.toPrecision(3)} 1/mm`);
    this.drawProfile(`${what}, ${border}`);
  }

  private drawProfile(what: string): void {
    const profile = this.profile();
    const most = Math.max(...profile.length, 1e-12);
    const reach = Math.max(...profile.along.map(Math.abs), 1e-12);
    const brightest = Math.max(...profile.image, 1);
    const total = Number(profile.mm.at(-1)!.toFixed(1));
    const points = (values: number[], scale = 1): Point[] => values.map((v, n) => [profile.mm[n]!, v * scale]);
    const short = (v: number) => Number(v.toPrecision(2));
    this.lengths.draw({
      x: [0, total],
      y: [0, 1.08 * most],
      draw: (pen) => {
        pen.axes([0, short(most / 2), short(most)]);
        pen.curve(points(profile.image, most / brightest), "#8b98a8", 1.2);
        pen.curve(points(profile.length), colour[this.chosen.name]);
      },
    });
    this.parts.draw({
      x: [0, total],
      y: [-1.1 * reach, 1.1 * reach],
      draw: (pen) => {
        pen.axes([-short(reach), 0, short(reach)]);
        pen.curve(points(profile.along), ink.along);
        pen.context.fillStyle = ink.meet;
        for (const mm of profile.meetings) pen.dot(mm, 0, 7);
      },
    });
    const here = vectorAt(this.around, this.cursor.at);
    this.caption.textContent = [
      what,
      here ? say("at the cross {n} 1/mm", { n: Math.hypot(...here).toPrecision(3) }) : say("the cross lies where no field was kept"),
      profile.meetings.length > 0
        ? say("vectors meet {mm} mm along the line", { mm: profile.meetings.map((mm) => figure(mm)).join(", ") })
        : say("no vectors meet on the line"),
      say("Drag on the picture to draw another line, click to move the cross."),
    ].join(" · ");
  }
}
