// Volumes over the beat. Dots are what was measured; the line between them is the volume of the surfaces shown.
import { splineWeights, volumeMl, type Wall } from "./cycle";
import type { FunctionNumbers, Results } from "./data";
import { figure, svg } from "./dom";
import type { Player } from "./player";
import { say, wall_words } from "./words";

const samples_per_gate = 10;
const margin = { left: 50, right: 20, top: 26, bottom: 40 };

const line_names = { ...wall_words, wall: say("wall") } as const;

interface Line {
  name: "endo" | "epi" | "wall";
  measured: (number | null)[];
  /** Between the gates, or null where the surface does not move smoothly. */
  between: number[] | null;
}

function linesOf({ gates }: Results, walls: Wall[]): Line[] {
  const n = gates.length;
  const between = (wall: Wall | undefined) => {
    if (!wall?.smooth) return null;
    return Array.from({ length: n * samples_per_gate + 1 }, (_, s) => {
      const shown = wall.at((s / samples_per_gate) % n)!;
      return volumeMl(shown.points, shown.triangles);
    });
  };
  const endo = between(walls.find((w) => w.name === "endo"));
  const epi = between(walls.find((w) => w.name === "epi"));
  const all: Line[] = [
    { name: "epi", measured: gates.map((g) => g.epi_ml), between: epi },
    { name: "wall", measured: gates.map((g) => g.wall_ml), between: endo && epi && epi.map((v, s) => v - endo[s]!) },
    { name: "endo", measured: gates.map((g) => g.endo_ml), between: endo },
  ];
  return all.filter((line) => line.measured.some((v) => v !== null));
}

/** Volume of the periodic fit; gate g of n stands for the time (g + 1/2) / n. */
export function fittedMl(fit: FunctionNumbers, time: number): number {
  return fit.cosine_ml.reduce((sum, c, k) => {
    const angle = 2 * Math.PI * (k + 1) * time;
    return sum + c * Math.cos(angle) + fit.sine_ml[k]! * Math.sin(angle);
  }, fit.mean_ml);
}

/** Round steps of an axis from 0 to at least `top`. */
function ticks(top: number): number[] {
  const raw = top / 5;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 2.5, 5, 10].map((m) => m * power).find((s) => s >= raw)!;
  return Array.from({ length: Math.ceil(top / step) + 1 }, (_, n) => n * step);
}

export class Curve {
  private readonly lines: Line[];
  private readonly top: number;
  private cursor = svg("g", {});
  private readonly chart = svg("svg", {
    class: "chart",
    role: "slider",
    tabindex: 0,
    "aria-label": say("Volumes over the beat; the cursor is the moment shown"),
    "aria-valuemin": 1,
  });

  constructor(
    private readonly place: HTMLElement,
    private readonly results: Results,
    walls: Wall[],
    private readonly player: Player,
  ) {
    this.lines = linesOf(results, walls);
    const intervals = results.gates.flatMap((g) => g.endo_ml_90 ?? []);
    const values = [...intervals, ...this.lines.flatMap((l) => [...l.measured, ...(l.between ?? [])])].filter((v) => v !== null);
    this.top = ticks(Math.max(...values, 1)).at(-1)!;
    this.chart.setAttribute("aria-valuemax", String(results.gates.length));
    place.replaceChildren(this.chart);
    this.chart.addEventListener("pointerdown", (event) => {
      this.chart.setPointerCapture(event.pointerId);
      this.seek(event);
    });
    this.chart.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) this.seek(event);
    });
    new ResizeObserver(() => this.draw()).observe(place);
    player.listen((phase) => this.moveCursor(phase));
  }

  private get gates(): number {
    return this.results.gates.length;
  }
  private get size(): [number, number] {
    return [Math.max(this.place.clientWidth, 200), Math.max(this.place.clientHeight, 160)];
  }
  private x(phase: number): number {
    const [width] = this.size;
    return margin.left + (phase / this.gates) * (width - margin.left - margin.right);
  }
  private y(ml: number): number {
    const [, height] = this.size;
    return height - margin.bottom - (ml / this.top) * (height - margin.top - margin.bottom);
  }

  private seek(event: PointerEvent): void {
    const box = this.chart.getBoundingClientRect();
    const share = (event.clientX - box.left - margin.left) / (box.width - margin.left - margin.right);
    this.player.pause();
    this.player.seek(Math.min(Math.max(share, 0), 1) * this.gates);
  }

  draw(): void {
    const [width, height] = this.size;
    this.chart.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.cursor = svg("g", { class: "cursor" });
    this.chart.replaceChildren(...this.axes(), ...this.phaseGuides(), ...this.band(), ...this.fit(), ...this.lines.flatMap((l) => this.plot(l)), this.cursor);
    this.moveCursor(this.player.phase);
  }

  private axes(): SVGElement[] {
    const [width, height] = this.size;
    const shapes: SVGElement[] = [];
    for (const ml of ticks(this.top * 0.999)) {
      shapes.push(svg("line", { class: "grid", x1: margin.left, x2: width - margin.right, y1: this.y(ml), y2: this.y(ml) }));
      shapes.push(svg("text", { class: "tick", x: margin.left - 8, y: this.y(ml) + 4, "text-anchor": "end" }, figure(ml, this.top < 4 ? 1 : 0)));
    }
    shapes.push(svg("text", { class: "axis", x: 2, y: 14 }, "mL"));
    const every = (width - margin.left) / this.gates < 26 ? 2 : 1;
    for (let g = 0; g <= this.gates; g += every) {
      const gate = this.results.gates[g % this.gates]!;
      const label = String((g % this.gates) + 1);
      shapes.push(svg("line", { class: "grid", x1: this.x(g), x2: this.x(g), y1: height - margin.bottom, y2: height - margin.bottom + 4 }));
      shapes.push(svg("text", { class: "tick", x: this.x(g), y: height - margin.bottom + 17, "text-anchor": "middle" }, label));
      const time = g === this.gates ? this.results.study.cycle_ms : gate.time_ms;
      if (time !== null && this.gates <= 8)
        shapes.push(svg("text", { class: "tick faint", x: this.x(g), y: height - margin.bottom + 31, "text-anchor": "middle" }, g === 0 ? "0 ms" : figure(time, 0)));
    }
    shapes.push(svg("text", { class: "axis", x: 2, y: height - margin.bottom + 17 }, say("gate")));
    return shapes;
  }

  private phaseGuides(): SVGElement[] {
    const { ed_gate, es_gate } = this.results;
    const height = this.size[1];
    const guides = [
      { gate: ed_gate, name: "ED" },
      { gate: es_gate, name: "ES" },
      { gate: this.results.phases?.end_rapid_filling ?? null, name: say("slow filling") },
    ];
    return guides.flatMap(({ gate, name }) => {
      if (gate === null) return [];
      const x = this.x(gate - 1);
      return [
        svg("line", { class: "guide", x1: x, x2: x, y1: margin.top - 4, y2: height - margin.bottom }),
        svg("text", { class: "guide", x, y: margin.top - 10, "text-anchor": "middle" }, name),
      ];
    });
  }

  /** The 90 % interval of the cavity between the gates; without one, what the periodic fit leaves unexplained. */
  private band(): SVGElement[] {
    const edges = this.intervals() ?? this.residuals();
    if (!edges) return [];
    const n = edges.low.length;
    const place = (ml: number, s: number) => `${this.x((s / (n - 1)) * this.gates).toFixed(1)},${this.y(ml).toFixed(1)}`;
    const points = [...edges.high.map(place), ...edges.low.map(place).reverse()];
    const area = svg("polygon", { class: "band", points: points.join(" ") });
    area.append(svg("title", {}, edges.title));
    return [area];
  }

  private intervals(): { low: number[]; high: number[]; title: string } | null {
    const ends = this.results.gates.map((g) => g.endo_ml_90);
    if (ends.some((e) => e?.[0] == null || e[1] == null)) return null;
    const between = (end: 0 | 1) =>
      Array.from({ length: this.gates * samples_per_gate + 1 }, (_, s) => {
        const weights = splineWeights(this.gates, s / samples_per_gate);
        return ends.reduce((sum, e, g) => sum + weights[g]! * e![end]!, 0);
      });
    return { low: between(0), high: between(1), title: say("90 % interval of the cavity's volume") };
  }

  private residuals(): { low: number[]; high: number[]; title: string } | null {
    const fit = this.results.measures?.function;
    if (!fit?.residual_ml) return null;
    const half = 1.645 * fit.residual_ml;
    const line = Array.from({ length: this.gates * samples_per_gate + 1 }, (_, s) =>
      fittedMl(fit, (s / samples_per_gate + 0.5) / this.gates),
    );
    return {
      low: line.map((v) => v - half),
      high: line.map((v) => v + half),
      title: say("scatter of the gates about the periodic fit: {ml} mL", { ml: figure(fit.residual_ml) }),
    };
  }

  private fit(): SVGElement[] {
    const fit = this.results.measures?.function;
    if (!fit) return [];
    const points = Array.from({ length: 16 * this.gates + 1 }, (_, n) => {
      const phase = n / 16;
      return `${this.x(phase).toFixed(1)},${this.y(fittedMl(fit, (phase + 0.5) / this.gates)).toFixed(1)}`;
    });
    const line = svg("polyline", { class: "line fit", points: points.join(" ") });
    line.append(svg("title", {}, say("periodic fit of {n} waves: EF {ef} %", { n: fit.waves, ef: figure(fit.ef_percent) })));
    return [line];
  }

  private plot(line: Line): SVGElement[] {
    const shapes: SVGElement[] = [];
    const stroke = { class: `line ${line.name}` };
    if (line.between) {
      const points = line.between.map((ml, s) => `${this.x(s / samples_per_gate).toFixed(1)},${this.y(ml).toFixed(1)}`);
      shapes.push(svg("polyline", { ...stroke, points: points.join(" ") }));
    } else {
      for (let g = 0; g + 1 < this.gates; ++g) {
        const [a, b] = [line.measured[g], line.measured[g + 1]];
        if (typeof a === "number" && typeof b === "number")
          shapes.push(svg("line", { ...stroke, x1: this.x(g), x2: this.x(g + 1), y1: this.y(a), y2: this.y(b) }));
      }
    }
    line.measured.forEach((ml, g) => {
      if (ml !== null) shapes.push(this.dot(line.name, this.x(g), this.y(ml), say("{line} gate {gate}: {ml} mL", { line: line_names[line.name], gate: g + 1, ml: figure(ml) })));
    });
    return shapes;
  }

  /** A shape of its own for each line: colour is never the only difference. */
  private dot(name: Line["name"], x: number, y: number, title: string): SVGElement {
    const attributes = { class: `dot ${name}` };
    const shape =
      name === "endo"
        ? svg("circle", { ...attributes, cx: x, cy: y, r: 4 })
        : name === "epi"
          ? svg("rect", { ...attributes, x: x - 3.5, y: y - 3.5, width: 7, height: 7 })
          : svg("path", { ...attributes, d: `M${x} ${y - 4.5}l4.5 8h-9z` });
    shape.append(svg("title", {}, title));
    return shape;
  }

  /** Value of a line at a phase: what the drawn curve says there. */
  private valueAt(line: Line, phase: number): number | null {
    const gate = Math.round(phase) % this.gates;
    if (!line.between || phase === Math.round(phase)) return line.measured[gate] ?? null;
    const at = phase * samples_per_gate;
    const first = Math.floor(at);
    return line.between[first]! + (at - first) * (line.between[first + 1]! - line.between[first]!);
  }

  private moveCursor(phase: number): void {
    const height = this.size[1];
    const x = this.x(phase);
    const shapes: SVGElement[] = [svg("line", { x1: x, x2: x, y1: margin.top - 4, y2: height - margin.bottom })];
    for (const line of this.lines) {
      const ml = this.valueAt(line, phase);
      if (ml !== null) shapes.push(svg("circle", { cx: x, cy: this.y(ml), r: 5, class: line.name }));
    }
    this.cursor.replaceChildren(...shapes);
    this.cursor.setAttribute("data-x", x.toFixed(1));
    const gate = (Math.round(phase) % this.gates) + 1;
    this.chart.setAttribute("aria-valuenow", String(gate));
    const endo = this.results.gates[gate - 1]?.endo_ml;
    this.chart.setAttribute("aria-valuetext", say("gate {gate}, cavity {ml} mL", { gate, ml: figure(endo) }));
  }
}

