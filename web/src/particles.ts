// The particles of a surface in numbers, at the step that is shown: how far they are, and how good its triangles are.
import type { Way } from "./data";
import { html } from "./dom";

const bands = ["#46125f", "#2d7a8c", "#4ac06e", "#fde725"] as const; // dark to bright: told apart by everyone
const band_names = ["< 1 voxel", "1 to 2", "2 to 3", "3 and more"] as const;
const ink = { axis: "#8b98a8", line: "#ffffff", dots: "#5aa9ff", triangles: "#d58ac0" } as const;
const margin = { left: 44, right: 10, top: 8, bottom: 22 };

/** Voxels from the nearest centre of a border voxel, negative inside. */
export function distanceOf(way: Way, kept: number, particle: number): number {
  return (way.distances[kept * way.particles + particle]! - 128) / 32;
}

/** Of each kept step the particles nearer than one, two and three voxels, each with the former, and all. */
export function countsOf(way: Way): number[][] {
  return way.steps.map((_, kept) => {
    const counts = [0, 0, 0, way.particles];
    for (let v = 0; v < way.particles; ++v) {
      const distance = Math.abs(distanceOf(way, kept, v));
      for (let band = 0; band < 3; ++band) if (distance < band + 1) ++counts[band]!;
    }
    return counts;
  });
}

/** mm² of every triangle at a kept step. */
export function areasOf(way: Way, kept: number): Float32Array {
  const areas = new Float32Array(way.triangles.length / 3);
  const at = (t: number, axis: number) => way.places[3 * (kept * way.particles + way.triangles[t]!) + axis]!;
  for (let t = 0; t < areas.length; ++t) {
    const [a, b] = [1, 2].map((corner) => [0, 1, 2].map((axis) => at(3 * t + corner, axis) - at(3 * t, axis)));
    const cross = [0, 1, 2].map((n) => a![(n + 1) % 3]! * b![(n + 2) % 3]! - a![(n + 2) % 3]! * b![(n + 1) % 3]!);
    areas[t] = Math.hypot(...cross) / 2;
  }
  return areas;
}

type Range = [number, number];
interface Chart {
  title: string;
  x: Range;
  y: Range;
  draw: (pen: Pen) => void;
}

/** A canvas with axes: x and y in the numbers of the chart. */
class Pen {
  constructor(
    readonly context: CanvasRenderingContext2D,
    private readonly wide: number,
    private readonly high: number,
    private readonly x: Range,
    private readonly y: Range,
  ) {}
  at(x: number, y: number): [number, number] {
    const along = (v: number, [low, high]: Range) => (v - low) / (high - low || 1);
    return [
      margin.left + along(x, this.x) * (this.wide - margin.left - margin.right),
      this.high - margin.bottom - along(y, this.y) * (this.high - margin.top - margin.bottom),
    ];
  }
  dot(x: number, y: number): void {
    const [left, top] = this.at(x, Math.min(Math.max(y, this.y[0]), this.y[1]));
    this.context.fillRect(left - 1, top - 1, 2, 2);
  }
  line(from: [number, number], to: [number, number], style: string): void {
    this.context.strokeStyle = style;
    this.context.beginPath();
    this.context.moveTo(...this.at(...from));
    this.context.lineTo(...this.at(...to));
    this.context.stroke();
  }
  axes(y_values: number[]): void {
    const { context } = this;
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = ink.axis;
    context.textBaseline = "middle";
    for (const value of y_values) {
      this.line([this.x[0], value], [this.x[1], value], "#ffffff1c");
      context.textAlign = "right";
      context.fillText(String(value), margin.left - 6, this.at(this.x[0], value)[1]);
    }
    context.textBaseline = "alphabetic";
    for (const [value, align] of [[this.x[0], "left"], [this.x[1], "right"]] as const) {
      context.textAlign = align;
      context.fillText(String(value), this.at(value, 0)[0], this.high - 6);
    }
  }
}

function bandLegend(): HTMLElement {
  return html(
    "p",
    { class: "bands" },
    ...bands.map((fill, n) => {
      const item = html("span", {}, band_names[n]!);
      item.style.setProperty("--band", fill);
      return item;
    }),
  );
}

export class ParticleCharts {
  private step = 0;
  private kept = 0;
  private readonly counts: number[][];
  private readonly most_area: number;
  private readonly charts: (Chart & { canvas: HTMLCanvasElement })[];

  constructor(
    place: HTMLElement,
    private readonly way: Way,
    name: string,
  ) {
    this.counts = countsOf(way);
    this.most_area = Math.max(...areasOf(way, 0), ...areasOf(way, way.steps.length - 1));
    const charts: Chart[] = [
      { title: "Particles by their distance from the border", x: [0, way.steps.at(-1)!], y: [0, way.particles], draw: (pen) => this.drawHistory(pen) },
      { title: "Distance of each particle, voxels, + outside", x: [0, way.particles], y: [-4, 4], draw: (pen) => this.drawDistances(pen) },
      { title: "Area of each triangle, mm²", x: [0, way.triangles.length / 3], y: [0, this.most_area], draw: (pen) => this.drawAreas(pen) },
    ];
    this.charts = charts.map((chart) => ({ ...chart, canvas: html("canvas", { role: "img", "aria-label": `${chart.title}, ${name}` }) }));
    place.replaceChildren(...this.charts.map(({ title, canvas }) => html("figure", {}, html("figcaption", {}, `${title}, ${name}`), canvas)));
    place.firstElementChild!.append(bandLegend());
    new ResizeObserver(() => this.draw()).observe(place);
  }

  show(step: number, kept: number): void {
    this.step = step;
    this.kept = kept;
    this.draw();
  }

  private draw(): void {
    const ratio = Math.min(devicePixelRatio, 2);
    for (const { canvas, x, y, draw } of this.charts) {
      const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
      if (wide === 0 || high === 0) continue;
      canvas.width = Math.round(wide * ratio);
      canvas.height = Math.round(high * ratio);
      const context = canvas.getContext("2d")!;
      context.scale(ratio, ratio);
      draw(new Pen(context, wide, high, x, y));
    }
  }

  private drawHistory(pen: Pen): void {
    const { steps, particles } = this.way;
    const { context } = pen;
    for (let band = 3; band >= 0; --band) {
      context.fillStyle = bands[band]!;
      context.beginPath();
      context.moveTo(...pen.at(0, 0));
      this.counts.forEach((counts, n) => context.lineTo(...pen.at(steps[n]!, counts[band]!)));
      context.lineTo(...pen.at(steps.at(-1)!, 0));
      context.fill();
    }
    pen.axes([0, particles]);
    const step = Math.min(this.step, steps.at(-1)!);
    pen.line([step, 0], [step, particles], ink.line);
  }

  private drawDistances(pen: Pen): void {
    pen.axes([-4, -2, 0, 2, 4]);
    pen.line([0, 0], [this.way.particles, 0], ink.axis);
    pen.context.fillStyle = ink.dots;
    for (let v = 0; v < this.way.particles; ++v) pen.dot(v, distanceOf(this.way, this.kept, v));
  }

  private drawAreas(pen: Pen): void {
    pen.axes([0, Math.round(this.most_area / 2), Math.round(this.most_area)]);
    pen.context.fillStyle = ink.triangles;
    areasOf(this.way, this.kept).forEach((area, t) => pen.dot(t, area));
  }
}
