// The particles of a surface in numbers, at the step that is shown: how far they are, and how good its triangles are.
import type { Way } from "./data";
import { html } from "./dom";
import { chartCanvas, type Chart, type DrawnChart, type Pen } from "./pen";
import { say } from "./words";

const bands = ["#46125f", "#2d7a8c", "#4ac06e", "#fde725"] as const; // dark to bright: told apart by everyone
const band_names = [say("< 1 voxel"), say("1 to 2"), say("2 to 3"), say("3 and more")] as const;
const ink = { line: "#ffffff", dots: "#5aa9ff", triangles: "#d58ac0" } as const;

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
  private readonly charts: (Chart & { drawn: DrawnChart })[];

  constructor(
    place: HTMLElement,
    private readonly way: Way,
    name: string,
  ) {
    this.counts = countsOf(way);
    this.most_area = Math.max(...areasOf(way, 0), ...areasOf(way, way.steps.length - 1));
    const charts: Chart[] = [
      { title: say("Particles by their distance from the border"), x: [0, way.steps.at(-1)!], y: [0, way.particles], draw: (pen) => this.drawHistory(pen) },
      { title: say("Distance of each particle, voxels, + outside"), x: [0, way.particles], y: [-4, 4], draw: (pen) => this.drawDistances(pen) },
      { title: say("Area of each triangle, mm²"), x: [0, way.triangles.length / 3], y: [0, this.most_area], draw: (pen) => this.drawAreas(pen) },
    ];
    this.charts = charts.map((chart) => ({ ...chart, drawn: chartCanvas(`${chart.title}, ${name}`, `${chart.title}, ${name}`) }));
    place.replaceChildren(...this.charts.map(({ drawn }) => drawn.figure));
    place.firstElementChild!.append(bandLegend());
    new ResizeObserver(() => this.draw()).observe(place);
  }

  show(step: number, kept: number): void {
    this.step = step;
    this.kept = kept;
    this.draw();
  }

  private draw(): void {
    for (const chart of this.charts) chart.drawn.draw(chart);
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
    pen.context.fillStyle = ink.dots;
    for (let v = 0; v < this.way.particles; ++v) pen.dot(v, distanceOf(this.way, this.kept, v));
  }

  private drawAreas(pen: Pen): void {
    pen.axes([0, Math.round(this.most_area / 2), Math.round(this.most_area)]);
    pen.context.fillStyle = ink.triangles;
    areasOf(this.way, this.kept).forEach((area, t) => pen.dot(t, area));
  }
}
