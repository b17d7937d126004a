// Draws planes of the stack: the image of a gate with what was found on it.
import type { Voxel } from "./cursor";
import { section, type Section, type Wall } from "./cycle";
import { mark, type Grid, type Pictures, type Polar, type Preview } from "./data";
import { colour } from "./dom";
import { say } from "./words";

export interface Overlay {
  contours: boolean;
  sections: boolean;
  edges: boolean;
  whole: boolean;
  brightness: number;
}

/** Part of a plane to draw, in voxels. */
export interface Frame {
  x0: number;
  x1: number;
  y0: number;
  y1: number;
}

const letters = [
  ["L", "R"],
  ["P", "A"],
  ["S", "I"],
] as const;

/** Where a direction of the grid points in the patient, the strongest part first: "LA". */
export function orientation(grid: Grid, axis: number, sign: 1 | -1): string {
  return [0, 1, 2]
    .map((row) => ({ row, part: sign * grid.direction[3 * row + axis]! }))
    .filter(({ part }) => Math.abs(part) > 0.38)
    .sort((a, b) => Math.abs(b.part) - Math.abs(a.part))
    .map(({ row, part }) => letters[row]![part > 0 ? 0 : 1])
    .join("");
}

/** A plane of the stack: `axis` stands on it, x and y lie in it; along the heart y runs upwards to the base. */
export class Plane {
  readonly x: number;
  readonly y: number;
  readonly upwards: boolean;
  constructor(readonly axis: 0 | 1 | 2) {
    [this.x, this.y] = axis === 2 ? [0, 1] : axis === 1 ? [0, 2] : [1, 2];
    this.upwards = axis !== 2;
  }
}

/** The voxel of a place in a plane through `at`; with a grid the nearest one inside it. */
export function voxelIn(plane: Plane, at: number, [x, y]: [number, number], inside?: Grid): Voxel {
  const kept = (v: number, axis: number) => (inside ? Math.min(Math.max(v, 0), inside.dims[axis]! - 1) : v);
  const voxel: Voxel = [0, 0, 0];
  voxel[plane.axis] = at;
  voxel[plane.x] = kept(x, plane.x);
  voxel[plane.y] = kept(y, plane.y);
  return voxel;
}

/** What a picture shows. */
export interface View {
  plane: Plane;
  at: number; // voxel along the plane's axis
  gate: number;
  segment: number; // lit, 0: none
  width: number; // of the lines of the surfaces, px
  letters: boolean;
  cross: [number, number, number] | null; // voxels where the other planes cut
  splash?: boolean; // the heart alone, its surfaces and nothing else
  over?: Drawing;
}

/** Draws over the image of a plane, where one unit is one voxel; `pixel`: so much of it is a pixel of the page. */
export type Drawing = (context: CanvasRenderingContext2D, pixel: number) => void;

/** Distance in mm within which a place in a slice belongs to the wall. */
const reach_mm = 9;

export class Painter {
  /** Surfaces of another run, drawn dashed under those of this one. */
  before: Wall[] = [];
  /** Drawn in the place of the marks of its gate. */
  preview: Preview | null = null;
  overlay: Overlay = { contours: true, sections: true, edges: false, whole: false, brightness: 1 };
  readonly heart: Frame & { z0: number; z1: number };
  private readonly sections = new WeakMap<Wall, Map<string, Section | null>>();
  private readonly scratch = document.createElement("canvas");

  constructor(
    readonly pictures: Pictures,
    readonly walls: Wall[],
    private readonly polar: Polar | null,
    /** Red, green and blue of each byte of the pictures; none: grey. */
    private readonly palette: Uint8Array | null = null,
  ) {
    this.heart = this.frameOfHeart();
  }

  /** Column and row in the middle of the heart. */
  get middle(): [number, number] {
    return [Math.round((this.heart.x0 + this.heart.x1) / 2), Math.round((this.heart.y0 + this.heart.y1) / 2)];
  }
  get grid(): Grid {
    return this.pictures.grid;
  }

  /** Square around all that was found, with a margin; the whole plane when nothing was. */
  private frameOfHeart(): Frame & { z0: number; z1: number } {
    const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
    let [low, high] = [Infinity, -Infinity];
    const include = (x: number, y: number) => {
      box.x0 = Math.min(box.x0, x);
      box.x1 = Math.max(box.x1, x);
      box.y0 = Math.min(box.y0, y);
      box.y1 = Math.max(box.y1, y);
    };
    for (const wall of this.walls)
      for (const mesh of wall.meshes)
        for (let n = 0; mesh && n < mesh.voxel.length; n += 3) {
          include(mesh.voxel[n]!, mesh.voxel[n + 1]!);
          low = Math.min(low, mesh.voxel[n + 2]!);
          high = Math.max(high, mesh.voxel[n + 2]!);
        }
    for (const { circle } of this.pictures.labels)
      if (circle) {
        include(circle[0] - circle[2], circle[1] - circle[2]);
        include(circle[0] + circle[2], circle[1] + circle[2]);
      }
    const { dims, spacing_mm } = this.grid;
    const margin = 14 / spacing_mm[2];
    const [z0, z1] = high > low ? [Math.max(low - margin, -0.5), Math.min(high + margin, dims[2] - 0.5)] : [-0.5, dims[2] - 0.5];
    const whole = { x0: -0.5, x1: dims[0] - 0.5, y0: -0.5, y1: dims[1] - 0.5, z0, z1 };
    if (!(box.x1 > box.x0)) return whole;
    const half = Math.max((box.x1 - box.x0) * spacing_mm[0], (box.y1 - box.y0) * spacing_mm[1]) / 2 + 14;
    const [x, y] = [(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2];
    return {
      x0: Math.max(x - half / spacing_mm[0], whole.x0),
      x1: Math.min(x + half / spacing_mm[0], whole.x1),
      y0: Math.max(y - half / spacing_mm[1], whole.y0),
      y1: Math.min(y + half / spacing_mm[1], whole.y1),
      z0,
      z1,
    };
  }

  /** The part of a plane that is shown: around the heart, or all of it where the user asked for that. */
  frameOf(plane: Plane, whole_allowed = true): Frame {
    const { dims } = this.grid;
    const heart = this.heart;
    const whole = { x0: -0.5, x1: dims[plane.x]! - 0.5, y0: -0.5, y1: dims[plane.y]! - 0.5 };
    if (this.overlay.whole && whole_allowed) return whole;
    if (plane.axis === 2) return heart;
    const [x0, x1] = plane.x === 0 ? [heart.x0, heart.x1] : [heart.y0, heart.y1];
    return whole_allowed ? { ...whole, x0, x1 } : { x0, x1, y0: heart.z0, y1: heart.z1 };
  }

  /** Where on a plane a pointer is, in voxels, and how many mm a pixel of the page is there. */
  placeAt(plane: Plane, canvas: HTMLCanvasElement, event: MouseEvent, whole_allowed = true): { place: [number, number]; mm: number } {
    const box = canvas.getBoundingClientRect();
    const view = this.viewOf(plane, canvas, whole_allowed);
    const scale = canvas.width / box.width;
    const x = ((event.clientX - box.left) * scale - view.left) / view.scale_x + view.frame.x0;
    const down = ((event.clientY - box.top) * scale - view.top) / view.scale_y;
    const y = plane.upwards ? view.frame.y1 - down : view.frame.y0 + down;
    return { place: [x, y], mm: (scale / view.scale_x) * this.grid.spacing_mm[plane.x]! };
  }

  voxelAt(plane: Plane, canvas: HTMLCanvasElement, event: MouseEvent, whole_allowed = true): [number, number] {
    const [x, y] = this.placeAt(plane, canvas, event, whole_allowed).place;
    const clamp = (v: number, axis: number) => Math.min(Math.max(Math.round(v), 0), this.grid.dims[axis]! - 1);
    return [clamp(x, plane.x), clamp(y, plane.y)];
  }

  /** The segment of the wall nearest to a voxel, 0 where none is near. */
  segmentNear(voxel: [number, number, number], gate: number): number {
    const spacing = this.grid.spacing_mm;
    let best = reach_mm ** 2;
    let segment = 0;
    for (const wall of this.walls) {
      const points = wall.meshes[gate]?.voxel;
      const segments = this.polar?.[wall.name][gate];
      if (!points || !segments) continue;
      for (let v = 0; v < segments.length; ++v) {
        let square = 0;
        for (let axis = 0; axis < 3; ++axis) square += ((points[3 * v + axis]! - voxel[axis]!) * spacing[axis]!) ** 2;
        if (square >= best || segments[v] === 0) continue;
        best = square;
        segment = segments[v]!;
      }
    }
    return segment;
  }

  /** How a frame fits a canvas with true proportions in mm. */
  private viewOf(plane: Plane, canvas: HTMLCanvasElement, whole_allowed: boolean) {
    const frame = this.frameOf(plane, whole_allowed);
    const [dx, dy] = [this.grid.spacing_mm[plane.x]!, this.grid.spacing_mm[plane.y]!];
    const [wide, high] = [(frame.x1 - frame.x0) * dx, (frame.y1 - frame.y0) * dy];
    const zoom = Math.min(canvas.width / wide, canvas.height / high);
    return {
      frame,
      scale_x: zoom * dx,
      scale_y: zoom * dy,
      left: (canvas.width - wide * zoom) / 2,
      top: (canvas.height - high * zoom) / 2,
    };
  }

  /** Fills a canvas, which must have a size in the page. */
  paint(canvas: HTMLCanvasElement, view: View): void {
    const ratio = Math.min(devicePixelRatio, 2);
    this.paintPixels(canvas, view, Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio), ratio);
  }

  /** The same in a canvas of so many pixels, `ratio` of them for one of the page. */
  paintPixels(canvas: HTMLCanvasElement, view: View, width: number, height: number, ratio: number): void {
    if (width === 0 || height === 0) return;
    const { plane, at, gate } = view;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext("2d")!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#000";
    context.fillRect(0, 0, width, height);
    const fit = this.viewOf(plane, canvas, !view.splash);
    // From here on one unit is one voxel.
    if (plane.upwards)
      context.setTransform(fit.scale_x, 0, 0, -fit.scale_y, fit.left - fit.frame.x0 * fit.scale_x, fit.top + fit.frame.y1 * fit.scale_y);
    else
      context.setTransform(fit.scale_x, 0, 0, fit.scale_y, fit.left - fit.frame.x0 * fit.scale_x, fit.top - fit.frame.y0 * fit.scale_y);
    const pixel = 1 / fit.scale_x;
    this.drawImage(context, plane, at, gate);
    if (!view.splash) this.drawMarks(context, plane, at, gate);
    if (view.splash || this.overlay.sections) this.drawSections(context, view, view.width * ratio * pixel);
    view.over?.(context, ratio * pixel);
    if (view.cross) this.drawCross(context, plane, view.cross, ratio * pixel);
    if (!view.letters) return;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.drawLetters(context, plane, width / ratio, height / ratio);
  }

  /** Calls visit(x, y, index in the arrays) for the pixels of a plane; x and y in bins in the plane, voxels along k. */
  private eachPixel(plane: Plane, at: number, gate: number, gates: number, visit: (x: number, y: number, index: number) => void): [number, number] {
    const { columns, rows, bin, grid } = this.pictures;
    const sizes = [columns, rows, grid.dims[2]];
    const fixed = plane.axis === 2 ? at : Math.floor(at / bin);
    const start = Math.min(gate, gates - 1) * columns * rows * grid.dims[2];
    const strides = [1, columns, columns * rows];
    const [wide, high] = [sizes[plane.x]!, sizes[plane.y]!];
    for (let y = 0; y < high; ++y)
      for (let x = 0; x < wide; ++x)
        visit(x, y, start + fixed * strides[plane.axis]! + x * strides[plane.x]! + y * strides[plane.y]!);
    return [wide, high];
  }

  private drawImage(context: CanvasRenderingContext2D, plane: Plane, at: number, gate: number): void {
    const { columns, rows, grid, bin, pixels, gates } = this.pictures;
    const sizes = [columns, rows, grid.dims[2]];
    const [wide, high] = [sizes[plane.x]!, sizes[plane.y]!];
    const image = new ImageData(wide, high);
    const gain = this.overlay.brightness;
    this.eachPixel(plane, at, gate, gates, (x, y, index) => {
      const n = 4 * (x + wide * y);
      for (let c = 0; c < 3; ++c)
        image.data[n + c] = this.palette ? this.palette[3 * pixels[index]! + c]! : Math.min(255, pixels[index]! * gain);
      image.data[n + 3] = 255;
    });
    this.scratch.width = wide;
    this.scratch.height = high;
    this.scratch.getContext("2d")!.putImageData(image, 0, 0);
    context.imageSmoothingEnabled = true;
    context.imageSmoothingQuality = "high";
    const bins = [bin, bin, 1];
    context.drawImage(this.scratch, -0.5, -0.5, wide * bins[plane.x]!, high * bins[plane.y]!);
  }

  private drawMarks(context: CanvasRenderingContext2D, plane: Plane, at: number, gate: number): void {
    const { marked_gates, bin } = this.pictures;
    const fresh = this.preview?.gate === gate ? this.preview.marks : null;
    const marks = fresh ?? this.pictures.marks;
    const first = fresh ? gate * fresh.length : 0;
    if (marked_gates === 0 || !(this.overlay.contours || this.overlay.edges)) return;
    const bins = [bin, bin, 1];
    const [bx, by] = [bins[plane.x]!, bins[plane.y]!];
    const dot = (x: number, y: number, size: number, style: string, part = 0) => {
      context.fillStyle = style;
      const [cx, cy] = [x * bx + (bx - 1) / 2, y * by + (by - 1) / 2];
      const [w, h] = [size * bx, size * by];
      if (part === 0) context.fillRect(cx - w / 2, cy - h / 2, w, h);
      else context.fillRect(part < 0 ? cx - w / 2 : cx, cy - h / 2, w / 2, h);
    };
    this.eachPixel(plane, at, gate, marked_gates, (x, y, index) => {
      const bits = marks[index - first]!;
      if (bits === 0) return;
      const border = this.overlay.contours ? bits & (mark.endo | mark.epi) : 0;
      if (this.overlay.edges && border === 0 && bits & (mark.major_edge | mark.minor_edge)) {
        const size = bits & mark.major_edge ? 0.5 : 0.32;
        context.globalAlpha = 0.8;
        dot(x, y, size + 0.22, "#000");
        context.globalAlpha = 1;
        dot(x, y, size, colour.edge);
      }
      context.globalAlpha = 0.85;
      // A voxel of both borders is half and half.
      if (border & mark.endo) dot(x, y, 0.5, colour.endo, border & mark.epi ? -1 : 0);
      if (border & mark.epi) dot(x, y, 0.5, colour.epi, border & mark.endo ? 1 : 0);
    });
    context.globalAlpha = 1;
  }

  /** Cuts are made once: they are drawn again for every beat and every segment that is pointed at. */
  sectionOf(wall: Wall, { plane, at, gate }: Pick<View, "plane" | "at" | "gate">): Section | null {
    const key = `${gate} ${plane.axis} ${at}`;
    const cuts = this.sections.get(wall) ?? new Map<string, Section | null>();
    this.sections.set(wall, cuts);
    let cut = cuts.get(key);
    if (cut === undefined) {
      const mesh = wall.meshes[gate];
      const triangles = wall.trianglesOf(gate);
      cut = mesh && triangles ? section(mesh.voxel, triangles, plane.axis, at) : null;
      cuts.set(key, cut);
    }
    return cut;
  }

  private drawSections(context: CanvasRenderingContext2D, view: View, width: number): void {
    const stroke = ({ lines, vertices }: Section, chosen: (vertex: number) => boolean, strokes: [number, string][]) => {
      context.beginPath();
      vertices.forEach((vertex, n) => {
        if (!chosen(vertex)) return;
        context.moveTo(lines[4 * n]!, lines[4 * n + 1]!);
        context.lineTo(lines[4 * n + 2]!, lines[4 * n + 3]!);
      });
      context.lineCap = "round";
      for (const [line_width, style] of strokes) {
        context.lineWidth = line_width;
        context.strokeStyle = style;
        context.stroke();
      }
    };
    // A cut is made of pieces too short for a pattern of dashes: one of three is left out.
    for (const wall of view.splash ? [] : this.before) {
      const cut = this.sectionOf(wall, view);
      if (cut) stroke(cut, (vertex) => vertex % 3 !== 0, [[width, "#ffffffb0"]]);
    }
    for (const wall of this.walls) {
      const cut = this.sectionOf(wall, view);
      if (!cut) continue;
      stroke(cut, () => true, [
        [width * 2, "rgba(0, 0, 0, 0.55)"],
        [width, colour[wall.name]],
      ]);
      const segments = this.polar?.[wall.name][view.gate];
      if (view.segment > 0 && segments) stroke(cut, (v) => segments[v] === view.segment, [[width * 2.2, colour.lit]]);
    }
  }

  /** Where the other planes cut this one. */
  private drawCross(context: CanvasRenderingContext2D, plane: Plane, at: [number, number, number], width: number): void {
    const { dims } = this.grid;
    context.strokeStyle = "rgba(255, 255, 255, 0.4)";
    context.lineWidth = width;
    context.setLineDash([4 * width, 4 * width]);
    context.beginPath();
    context.moveTo(at[plane.x]!, -0.5);
    context.lineTo(at[plane.x]!, dims[plane.y]! - 0.5);
    context.moveTo(-0.5, at[plane.y]!);
    context.lineTo(dims[plane.x]! - 0.5, at[plane.y]!);
    context.stroke();
    context.setLineDash([]);
  }

  private drawLetters(context: CanvasRenderingContext2D, plane: Plane, width: number, height: number): void {
    context.font = "600 11px system-ui, sans-serif";
    context.fillStyle = "rgba(255, 255, 255, 0.85)";
    context.textBaseline = "middle";
    context.textAlign = "left";
    context.fillText(orientation(this.grid, plane.x, -1), 6, height / 2);
    context.textAlign = "right";
    context.fillText(orientation(this.grid, plane.x, 1), width - 6, height / 2);
    context.textAlign = "center";
    const up = plane.upwards ? 1 : -1;
    const name = (sign: 1 | -1) => (plane.upwards ? (sign === 1 ? say("Base") : say("Apex")) : orientation(this.grid, plane.y, sign));
    context.fillText(name(up), width / 2, 11);
    context.fillText(name(-up as 1 | -1), width / 2, height - 10);
  }
}
