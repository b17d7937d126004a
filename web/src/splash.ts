// The heart at a glance: rows of short-axis slices from apex to base and of cuts along it, relaxed above contracted.
import { html } from "./dom";
import { Painter, Plane } from "./painter";
import { say } from "./words";

interface Picture {
  canvas: HTMLCanvasElement;
  plane: Plane;
  at: number;
  gate: number;
}

/** Whole numbers spread evenly from one to another, both among them. */
function spread(from: number, to: number, count: number): number[] {
  const steps = Math.min(count, to - from + 1);
  return Array.from({ length: steps }, (_, n) => Math.round(from + ((to - from) * n) / Math.max(steps - 1, 1)));
}

/** First and last slice that the surfaces reach in a gate. */
function slicesOf(painter: Painter, gate: number): [number, number] {
  let [low, high] = [Infinity, -Infinity];
  for (const wall of painter.walls) {
    const points = wall.meshes[gate]?.voxel ?? [];
    for (let n = 2; n < points.length; n += 3) {
      low = Math.min(low, points[n]!);
      high = Math.max(high, points[n]!);
    }
  }
  const last = painter.grid.dims[2] - 1;
  if (!(high >= low)) return [0, last];
  return [Math.max(0, Math.ceil(low)), Math.min(last, Math.floor(high))];
}

export class Splash {
  private readonly pictures: Picture[] = [];
  private lit = 0;

  /**
   * `moments`: what is shown, gates from 0. `point` is told the segment under the pointer, 0: none.
   * `columns`: short-axis slices in a row.
   */
  constructor(
    readonly place: HTMLElement,
    private readonly painter: Painter,
    moments: { name: string; gate: number }[],
    columns: number,
    private readonly point: (segment: number) => void = () => {},
  ) {
    const short = new Plane(2);
    const [first, last] = slicesOf(painter, moments[0]!.gate);
    const slices = spread(first, last, columns);
    const rows = moments.map(({ name, gate }) =>
      this.row(say("Short axis, {moment}", { moment: name }), slices.map((at) => this.picture(short, at, gate, say("slice {slice}", { slice: at + 1 }))), "short-row"),
    );
    const [x, y] = painter.middle;
    const [dx, dy] = [12 / painter.grid.spacing_mm[0], 12 / painter.grid.spacing_mm[1]];
    for (const { name, gate } of moments) {
      const upright = [-dx, 0, dx].map((d) => this.picture(new Plane(0), Math.round(x + d), gate, say("vertical")));
      const level = [-dy, 0, dy].map((d) => this.picture(new Plane(1), Math.round(y + d), gate, say("horizontal")));
      rows.push(this.row(say("Long axes, {moment}", { moment: name }), [...upright, ...level], "long-row"));
    }
    place.replaceChildren(...rows);
    new ResizeObserver(() => this.draw()).observe(place);
  }

  private picture(plane: Plane, at: number, gate: number, name: string): HTMLElement {
    const canvas = html("canvas", { role: "img", "aria-label": `${name}, ${say("gate {gate}", { gate: gate + 1 })}` });
    const frame = this.painter.frameOf(plane, false);
    const { spacing_mm } = this.painter.grid;
    const ratio = ((frame.x1 - frame.x0) * spacing_mm[plane.x]!) / ((frame.y1 - frame.y0) * spacing_mm[plane.y]!);
    canvas.style.aspectRatio = String(ratio);
    this.pictures.push({ canvas, plane, at, gate });
    canvas.addEventListener("pointermove", (event) => {
      const [x, y] = this.painter.voxelAt(plane, canvas, event, false);
      const voxel: [number, number, number] = [0, 0, 0];
      voxel[plane.axis] = at;
      voxel[plane.x] = x;
      voxel[plane.y] = y;
      this.point(this.painter.segmentNear(voxel, gate));
    });
    canvas.addEventListener("pointerleave", () => this.point(0));
    return html("figure", {}, canvas, plane.axis === 2 ? html("figcaption", {}, String(at + 1)) : "");
  }

  private row(name: string, pictures: HTMLElement[], kind: string): HTMLElement {
    return html("div", { class: `splash-row ${kind}` }, html("h3", {}, name), html("div", {}, ...pictures));
  }

  light(segment: number): void {
    if (segment === this.lit) return;
    this.lit = segment;
    this.draw();
  }

  draw(): void {
    for (const { canvas, plane, at, gate } of this.pictures)
      this.painter.paint(canvas, { plane, at, gate, segment: this.lit, width: 1.2, letters: false, cross: null, splash: true });
  }
}
