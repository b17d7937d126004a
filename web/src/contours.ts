// Contours that were propagated from slice to slice: each on its slice with the forces on its points, and all in space.
import { BufferGeometry, Float32BufferAttribute, LineBasicMaterial, LineLoop } from "three";

import { toWorld, type Cursor } from "./cursor";
import type { Wall } from "./cycle";
import { walls, type Contours, type SliceContour, type WallName } from "./data";
import { colour, figure, html } from "./dom";
import { Painter, Plane } from "./painter";
import { Stage3d } from "./stage3d";
import { say, wall_words } from "./words";

const ink = { pull: "#ffe14d", bend: "#ff7ac8", start: "#dfe6ee" } as const;
/** The strongest force of a kind is drawn so long, px of the image. */
const strongest_px = 2;

/** Shortest, mean and longest edge, px, and the area inside, px². */
export function shapeOf({ points }: SliceContour): { edges: [number, number, number]; area: number } {
  const count = points.length / 2;
  const lengths: number[] = [];
  let twice = 0;
  for (let n = 0; n < count; ++n) {
    const m = (n + 1) % count;
    lengths.push(Math.hypot(points[2 * m]! - points[2 * n]!, points[2 * m + 1]! - points[2 * n + 1]!));
    twice += points[2 * n]! * points[2 * m + 1]! - points[2 * m]! * points[2 * n + 1]!;
  }
  const mean = lengths.reduce((sum, v) => sum + v, 0) / count;
  return { edges: [Math.min(...lengths), mean, Math.max(...lengths)], area: Math.abs(twice) / 2 };
}

export class ContourView {
  private readonly plane = new Plane(2);
  private readonly painter: Painter;
  private readonly canvas = html("canvas", { class: "field-plane", role: "img" });
  private readonly caption = html("p", { class: "caption", "aria-live": "polite" });
  private readonly slider: HTMLInputElement;
  private readonly shows = { forces: true, start: true };
  private readonly stage: Stage3d | null;
  private readonly rings: { slice: number; ring: LineLoop; name: WallName }[] = [];

  constructor(
    place: HTMLElement,
    private readonly contours: Contours,
    pictures: Painter["pictures"],
    surfaces: Wall[],
    private readonly cursor: Cursor,
  ) {
    this.painter = new Painter(pictures, surfaces, null);
    this.painter.overlay = { contours: false, sections: false, edges: false, whole: false, brightness: 1 };
    this.slider = html("input", { type: "range", min: 1, max: pictures.grid.dims[2], step: 1, "aria-label": say("Slice of the contours, 1 is the apex") });
    this.slider.addEventListener("input", () => cursor.move([cursor.at[0], cursor.at[1], this.slider.valueAsNumber - 1]));
    this.stage = this.stack();
    const toggle = (key: "forces" | "start", name: string) => {
      const box = html("input", { type: "checkbox", checked: true });
      box.addEventListener("change", () => {
        this.shows[key] = box.checked;
        this.draw();
      });
      return html("label", { class: "select" }, box, ` ${name}`);
    };
    place.replaceChildren(
      html("div", { class: "motion-bar" }, this.slider, toggle("forces", say("Forces")), toggle("start", say("Start"))),
      html("div", { class: "contour-body" }, html("div", {}, this.canvas), ...(this.stage ? [this.stage.frame] : [])),
      this.caption,
    );
    new ResizeObserver(() => this.draw()).observe(place);
    cursor.listen(() => this.draw());
  }

  private at(name: WallName, slice: number): SliceContour | null {
    return this.contours[name]?.slices[slice] ?? null;
  }

  /** All contours in space; null where the browser draws none. */
  private stack(): Stage3d | null {
    const { grid } = this.painter;
    const loops = walls.flatMap((name) =>
      (this.contours[name]?.slices ?? []).flatMap((contour, slice) => {
        if (!contour) return [];
        const world: number[] = [];
        for (let n = 0; n < contour.points.length; n += 2) world.push(...toWorld(grid, [contour.points[n]!, contour.points[n + 1]!, slice]));
        return [{ name, slice, world }];
      }),
    );
    try {
      const stage = new Stage3d(grid, loops.flatMap(({ world }) => world), say("The stack of contours. Drag to turn."));
      for (const { name, slice, world } of loops) {
        const geometry = new BufferGeometry();
        geometry.setAttribute("position", new Float32BufferAttribute(world, 3));
        const ring = new LineLoop(geometry, new LineBasicMaterial({ color: colour[name] }));
        this.rings.push({ slice, ring, name });
        stage.heart.add(ring);
      }
      return stage;
    } catch {
      return null;
    }
  }

  /** What the contour started from: that of the slice before it, seen from the slice where all began. */
  private startOf(name: WallName, slice: number): SliceContour | null {
    const best = this.contours[name]?.best_slice ?? -1;
    return slice === best ? null : this.at(name, slice + (slice > best ? -1 : 1));
  }

  private drawLoop(context: CanvasRenderingContext2D, { points }: SliceContour, style: string, width: number): void {
    context.beginPath();
    for (let n = 0; n < points.length; n += 2) context.lineTo(points[n]!, points[n + 1]!);
    context.closePath();
    context.strokeStyle = style;
    context.lineWidth = width;
    context.stroke();
  }

  private drawForces(context: CanvasRenderingContext2D, points: number[], forces: number[], style: string, pixel: number): void {
    let strongest = 1e-12;
    for (let n = 0; n < forces.length; n += 2) strongest = Math.max(strongest, Math.hypot(forces[n]!, forces[n + 1]!));
    context.strokeStyle = style;
    context.lineWidth = 1.2 * pixel;
    context.beginPath();
    for (let n = 0; n < forces.length; n += 2) {
      context.moveTo(points[n]!, points[n + 1]!);
      context.lineTo(points[n]! + (strongest_px * forces[n]!) / strongest, points[n + 1]! + (strongest_px * forces[n + 1]!) / strongest);
    }
    context.stroke();
  }

  private drawContour(context: CanvasRenderingContext2D, pixel: number, name: WallName): void {
    const contour = this.at(name, this.cursor.at[2]);
    const start = this.startOf(name, this.cursor.at[2]);
    if (!contour) return;
    if (this.shows.start && start) {
      context.setLineDash([3 * pixel, 3 * pixel]);
      this.drawLoop(context, start, ink.start, 1.2 * pixel);
      context.setLineDash([]);
    }
    this.drawLoop(context, contour, colour[name], 2 * pixel);
    context.fillStyle = colour[name];
    for (let n = 0; n < contour.points.length; n += 2) {
      context.beginPath();
      context.arc(contour.points[n]!, contour.points[n + 1]!, 2.6 * pixel, 0, 2 * Math.PI);
      context.fill();
    }
    if (!this.shows.forces) return;
    this.drawForces(context, contour.points, contour.pulls, ink.pull, pixel);
    this.drawForces(context, contour.points, contour.bends, ink.bend, pixel);
  }

  draw(): void {
    if (this.canvas.clientWidth === 0) return;
    const slice = this.cursor.at[2];
    const frame = this.painter.frameOf(this.plane);
    const { spacing_mm } = this.painter.grid;
    this.canvas.style.aspectRatio = String(((frame.x1 - frame.x0) * spacing_mm[0]) / ((frame.y1 - frame.y0) * spacing_mm[1]));
    this.slider.value = String(slice + 1);
    this.painter.paint(this.canvas, {
      plane: this.plane,
      at: slice,
      gate: this.contours.gate,
      segment: 0,
      width: 1,
      letters: true,
      cross: null,
      over: (context, pixel) => walls.forEach((name) => this.drawContour(context, pixel, name)),
    });
    this.canvas.setAttribute("aria-label", say("Contours of slice {slice}, gate {gate}", { slice: slice + 1, gate: this.contours.gate + 1 }));
    for (const { slice: of, ring, name } of this.rings) (ring.material as LineBasicMaterial).color.set(of === slice ? colour.lit : colour[name]);
    this.stage?.render();
    const words = walls.flatMap((name) => {
      const contour = this.at(name, slice);
      if (!contour) return [];
      const { edges, area } = shapeOf(contour);
      const [shortest, mean, longest] = edges.map((edge) => figure(edge)) as [string, string, string];
      const numbers = { wall: wall_words[name], n: contour.points.length / 2, shortest, mean, longest, area: figure(area) };
      const text = say("{wall}: {n} points, edges of {shortest}, {mean} and {longest} px (shortest, mean, longest), {area} px²", numbers);
      return [this.contours[name]!.best_slice === slice ? `${text}, ${say("the first of all")}` : text];
    });
    this.caption.textContent = [say("Slice {slice}", { slice: slice + 1 }), ...(words.length > 0 ? words : [say("no contour here")])].join(" · ");
  }
}
