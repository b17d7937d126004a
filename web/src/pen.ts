// Small charts on a canvas: a title, axes, and what is drawn between them.
import { html } from "./dom";

const margin = { left: 44, right: 10, top: 8, bottom: 22 };
const ink = { axis: "#8b98a8", grid: "#ffffff1c" } as const;

export type Range = [number, number];
export interface Chart {
  title: string;
  x: Range;
  y: Range;
  draw: (pen: Pen) => void;
}

/** Draws into a canvas in the numbers of its chart. */
export class Pen {
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

  dot(x: number, y: number, size = 2): void {
    const [left, top] = this.at(x, Math.min(Math.max(y, this.y[0]), this.y[1]));
    this.context.fillRect(left - size / 2, top - size / 2, size, size);
  }

  line(from: [number, number], to: [number, number], style: string): void {
    this.curve([from, to], style, 1);
  }

  curve(points: [number, number][], style: string, width = 1.6): void {
    this.context.strokeStyle = style;
    this.context.lineWidth = width;
    this.context.beginPath();
    points.forEach((p, n) => (n === 0 ? this.context.moveTo(...this.at(...p)) : this.context.lineTo(...this.at(...p))));
    this.context.stroke();
  }

  axes(y_values: number[]): void {
    const { context } = this;
    context.font = "11px system-ui, sans-serif";
    context.fillStyle = ink.axis;
    context.textBaseline = "middle";
    for (const value of y_values) {
      this.line([this.x[0], value], [this.x[1], value], value === 0 ? ink.axis : ink.grid);
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

export interface DrawnChart {
  canvas: HTMLCanvasElement;
  figure: HTMLElement;
  draw: (chart: Omit<Chart, "title">) => void;
}

/** A chart whose ranges and contents are given each time that it is drawn. */
export function chartCanvas(title: string, label: string): DrawnChart {
  const canvas = html("canvas", { role: "img", "aria-label": label });
  const figure = html("figure", {}, html("figcaption", {}, title), canvas);
  const draw = ({ x, y, draw: fill }: Omit<Chart, "title">) => {
    const ratio = Math.min(devicePixelRatio, 2);
    const [wide, high] = [canvas.clientWidth, canvas.clientHeight];
    if (wide === 0 || high === 0) return;
    canvas.width = Math.round(wide * ratio);
    canvas.height = Math.round(high * ratio);
    const context = canvas.getContext("2d")!;
    context.scale(ratio, ratio);
    fill(new Pen(context, wide, high, x, y));
  };
  return { canvas, figure, draw };
}
