// Every slice of the gate that the beat is at, with what was found on it: all short-axis slices as tiles, one of them
// large, and two cuts along the heart.
import { section, type Wall } from "./cycle";
import { mark, type Grid, type Pictures } from "./data";
import { colour, html } from "./dom";

export interface Overlay {
  contours: boolean;
  sections: boolean;
  edges: boolean;
  whole: boolean;
  brightness: number;
}

/** Part of a plane to draw, in voxels. */
interface Frame {
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
class Plane {
  readonly x: number;
  readonly y: number;
  readonly upwards: boolean;
  constructor(readonly axis: 0 | 1 | 2) {
    [this.x, this.y] = axis === 2 ? [0, 1] : axis === 1 ? [0, 2] : [1, 2];
    this.upwards = axis !== 2;
  }
}

export class Slices {
  slice: number;
  overlay: Overlay = { contours: true, sections: true, edges: false, whole: false, brightness: 1 };
  gate = 0;
  private readonly centre: [number, number];
  private readonly heart: Frame;
  private readonly tiles: { button: HTMLButtonElement; canvas: HTMLCanvasElement }[] = [];
  private readonly sheet = html("div", { class: "tiles", role: "group", "aria-label": "All slices, apex first" });
  private readonly large = html("canvas", { class: "large", role: "img" });
  private readonly long = html("div", { class: "long" });
  private readonly cuts: { plane: Plane; canvas: HTMLCanvasElement }[];
  private readonly caption = html("p", { class: "caption", "aria-live": "polite" });
  private readonly slider: HTMLInputElement;
  private readonly scratch = document.createElement("canvas");

  constructor(
    place: HTMLElement,
    private readonly pictures: Pictures,
    private readonly walls: Wall[],
  ) {
    const { dims } = pictures.grid;
    this.heart = this.frameOfHeart();
    this.centre = [
      Math.round((this.heart.x0 + this.heart.x1) / 2),
      Math.round((this.heart.y0 + this.heart.y1) / 2),
    ];
    const labels = pictures.labels[0];
    this.slice = labels && labels.big_slice >= 0 ? labels.big_slice : Math.floor(dims[2] / 2);
    this.slider = html("input", { type: "range", min: 1, max: dims[2], step: 1, "aria-label": "Slice, 1 is the apex" });
    this.slider.addEventListener("input", () => this.choose(this.slider.valueAsNumber - 1));
    this.cuts = ([1, 0] as const).map((axis) => ({
      plane: new Plane(axis),
      canvas: html("canvas", { class: "cut", role: "img" }),
    }));
    this.build(place);
    new ResizeObserver(() => this.layOut()).observe(this.large);
  }

  choose(slice: number): void {
    this.slice = Math.min(Math.max(slice, 0), this.pictures.grid.dims[2] - 1);
    this.draw();
  }

  private build(place: HTMLElement): void {
    for (let k = 0; k < this.pictures.grid.dims[2]; ++k) {
      const canvas = html("canvas", {});
      const button = html("button", { class: "tile", "aria-label": `Slice ${k + 1}` }, canvas, html("span", {}, String(k + 1)));
      button.addEventListener("click", () => this.choose(k));
      this.sheet.append(button);
      this.tiles.push({ button, canvas });
    }
    this.large.addEventListener("pointerdown", (event) => {
      const at = this.voxelAt(new Plane(2), this.large, event);
      this.centre[0] = at[0];
      this.centre[1] = at[1];
      this.draw();
    });
    for (const { plane, canvas } of this.cuts)
      canvas.addEventListener("pointerdown", (event) => this.choose(this.voxelAt(plane, canvas, event)[1]));
    this.long.append(...this.cuts.map(({ canvas }) => canvas));
    place.replaceChildren(
      html("div", { class: "short" }, this.large, html("div", { class: "under" }, this.slider, this.caption)),
      this.long,
      this.sheet,
    );
  }

  /** Gives all parts their shapes, then draws. */
  layOut(): void {
    for (const { plane, canvas } of this.cuts) {
      const frame = this.frameOf(plane);
      const [dx, dy] = [this.grid.spacing_mm[plane.x]!, this.grid.spacing_mm[plane.y]!];
      canvas.style.aspectRatio = String(((frame.x1 - frame.x0) * dx) / ((frame.y1 - frame.y0) * dy));
    }
    this.arrangeTiles();
    this.draw();
  }

  /** As few tiles in a row as fit beside the large slices; a row of usual tiles where they stand below them. */
  private arrangeTiles(): void {
    const gap = 6;
    const width = this.sheet.clientWidth;
    const beside = this.sheet.offsetTop < this.large.offsetTop + this.large.offsetHeight / 2;
    const long = this.cuts.reduce((sum, { canvas }) => sum + canvas.clientHeight + 2 * gap, 0);
    const height = Math.max(this.large.clientHeight + 50, long);
    const count = this.tiles.length;
    let columns = Math.max(1, Math.floor(width / 104));
    if (beside) {
      const fits = (c: number) => Math.ceil(count / c) * ((width - gap * (c - 1)) / c + gap) <= height;
      for (columns = 1; columns < count && !fits(columns); ++columns);
    }
    this.sheet.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  }

  private get grid(): Grid {
    return this.pictures.grid;
  }

  /** Square around all that was found, with a margin; the whole plane when nothing was. */
  private frameOfHeart(): Frame {
    const box = { x0: Infinity, x1: -Infinity, y0: Infinity, y1: -Infinity };
    const include = (x: number, y: number) => {
      box.x0 = Math.min(box.x0, x);
      box.x1 = Math.max(box.x1, x);
      box.y0 = Math.min(box.y0, y);
      box.y1 = Math.max(box.y1, y);
    };
    for (const wall of this.walls)
      for (const mesh of wall.meshes)
        for (let n = 0; mesh && n < mesh.voxel.length; n += 3) include(mesh.voxel[n]!, mesh.voxel[n + 1]!);
    for (const { circle } of this.pictures.labels)
      if (circle) {
        include(circle[0] - circle[2], circle[1] - circle[2]);
        include(circle[0] + circle[2], circle[1] + circle[2]);
      }
    const { dims, spacing_mm } = this.grid;
    const whole = { x0: -0.5, x1: dims[0] - 0.5, y0: -0.5, y1: dims[1] - 0.5 };
    if (!(box.x1 > box.x0)) return whole;
    const half = Math.max((box.x1 - box.x0) * spacing_mm[0], (box.y1 - box.y0) * spacing_mm[1]) / 2 + 14;
    const [x, y] = [(box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2];
    return {
      x0: Math.max(x - half / spacing_mm[0], whole.x0),
      x1: Math.min(x + half / spacing_mm[0], whole.x1),
      y0: Math.max(y - half / spacing_mm[1], whole.y0),
      y1: Math.min(y + half / spacing_mm[1], whole.y1),
    };
  }

  private frameOf(plane: Plane): Frame {
    const { dims } = this.grid;
    const heart = this.heart;
    const whole = { x0: -0.5, x1: dims[plane.x]! - 0.5, y0: -0.5, y1: dims[plane.y]! - 0.5 };
    if (this.overlay.whole) return whole;
    if (plane.axis === 2) return heart;
    const [x0, x1] = plane.x === 0 ? [heart.x0, heart.x1] : [heart.y0, heart.y1];
    return { ...whole, x0, x1 };
  }

  private voxelAt(plane: Plane, canvas: HTMLCanvasElement, event: PointerEvent): [number, number] {
    const box = canvas.getBoundingClientRect();
    const view = this.viewOf(plane, canvas);
    const scale = canvas.width / box.width;
    const x = ((event.clientX - box.left) * scale - view.left) / view.scale_x + view.frame.x0;
    const down = ((event.clientY - box.top) * scale - view.top) / view.scale_y;
    const y = plane.upwards ? view.frame.y1 - down : view.frame.y0 + down;
    const clamp = (v: number, axis: number) => Math.min(Math.max(Math.round(v), 0), this.grid.dims[axis]! - 1);
    return [clamp(x, plane.x), clamp(y, plane.y)];
  }

  /** How a frame fits a canvas with true proportions in mm. */
  private viewOf(plane: Plane, canvas: HTMLCanvasElement) {
    const frame = this.frameOf(plane);
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

  draw(): void {
    const labels = this.pictures.labels[this.gate];
    const short = new Plane(2);
    this.tiles.forEach(({ button, canvas }, k) => {
      this.drawPlane(canvas, short, k, false);
      button.setAttribute("aria-pressed", String(k === this.slice));
      button.classList.toggle("found", labels?.base_slice === k || labels?.division_slice === k);
      button.title = [
        `Slice ${k + 1}`,
        labels?.division_slice === k ? "division slice: one border below, two above" : "",
        labels?.base_slice === k ? "highest slice of the ventricle" : "",
        labels?.big_slice === k ? "widest border" : "",
      ].filter(Boolean).join(", ");
    });
    this.drawPlane(this.large, short, this.slice, true);
    this.large.setAttribute("aria-label", `Short-axis slice ${this.slice + 1}, gate ${this.gate + 1}`);
    for (const { plane, canvas } of this.cuts) {
      const at = this.centre[plane.axis === 1 ? 1 : 0]!;
      this.drawPlane(canvas, plane, at, true);
      canvas.setAttribute("aria-label", `Cut along the heart, gate ${this.gate + 1}, slice ${this.slice + 1} marked`);
    }
    this.slider.value = String(this.slice + 1);
    const count = this.grid.dims[2];
    const words = [`Slice ${this.slice + 1} of ${count}`];
    if (this.slice === 0) words.push("apical end");
    if (this.slice === count - 1) words.push("basal end");
    if (labels?.division_slice === this.slice) words.push("division slice");
    if (labels?.base_slice === this.slice) words.push("base of the ventricle");
    this.caption.textContent = words.join(" · ");
  }

  private drawPlane(canvas: HTMLCanvasElement, plane: Plane, at: number, rich: boolean): void {
    const ratio = Math.min(devicePixelRatio, 2);
    const [width, height] = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
    if (width === 0 || height === 0) return;
    if (canvas.width !== width || canvas.height !== height) {
      canvas.width = width;
      canvas.height = height;
    }
    const context = canvas.getContext("2d")!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = "#000";
    context.fillRect(0, 0, width, height);
    const view = this.viewOf(plane, canvas);
    // From here on one unit is one voxel.
    if (plane.upwards)
      context.setTransform(view.scale_x, 0, 0, -view.scale_y, view.left - view.frame.x0 * view.scale_x, view.top + view.frame.y1 * view.scale_y);
    else
      context.setTransform(view.scale_x, 0, 0, view.scale_y, view.left - view.frame.x0 * view.scale_x, view.top - view.frame.y0 * view.scale_y);
    const pixel = 1 / view.scale_x;
    this.drawImage(context, plane, at);
    this.drawMarks(context, plane, at);
    if (this.overlay.sections) this.drawSections(context, plane, at, (rich ? 1.8 : 1.1) * ratio * pixel);
    if (rich) {
      this.drawCross(context, plane, ratio * pixel);
      context.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.drawLetters(context, plane, canvas.clientWidth, canvas.clientHeight);
    }
  }

  /** Calls visit(x, y, index in the arrays) for the pixels of a plane; x and y in bins in the plane, voxels along k. */
  private eachPixel(plane: Plane, at: number, gates: number, visit: (x: number, y: number, index: number) => void): [number, number] {
    const { columns, rows, bin, grid } = this.pictures;
    const sizes = [columns, rows, grid.dims[2]];
    const fixed = plane.axis === 2 ? at : Math.floor(at / bin);
    const start = Math.min(this.gate, gates - 1) * columns * rows * grid.dims[2];
    const strides = [1, columns, columns * rows];
    const [wide, high] = [sizes[plane.x]!, sizes[plane.y]!];
    for (let y = 0; y < high; ++y)
      for (let x = 0; x < wide; ++x)
        visit(x, y, start + fixed * strides[plane.axis]! + x * strides[plane.x]! + y * strides[plane.y]!);
    return [wide, high];
  }

  private drawImage(context: CanvasRenderingContext2D, plane: Plane, at: number): void {
    const { columns, rows, grid, bin, pixels, gates } = this.pictures;
    const sizes = [columns, rows, grid.dims[2]];
    const [wide, high] = [sizes[plane.x]!, sizes[plane.y]!];
    const image = new ImageData(wide, high);
    const gain = this.overlay.brightness;
    this.eachPixel(plane, at, gates, (x, y, index) => {
      const grey = Math.min(255, pixels[index]! * gain);
      const n = 4 * (x + wide * y);
      image.data[n] = image.data[n + 1] = image.data[n + 2] = grey;
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

  private drawMarks(context: CanvasRenderingContext2D, plane: Plane, at: number): void {
    const { marks, marked_gates, bin } = this.pictures;
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
    this.eachPixel(plane, at, marked_gates, (x, y, index) => {
      const bits = marks[index]!;
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

  private drawSections(context: CanvasRenderingContext2D, plane: Plane, at: number, width: number): void {
    for (const wall of this.walls) {
      const mesh = wall.meshes[this.gate];
      const triangles = wall.trianglesOf(this.gate);
      if (!mesh || !triangles) continue;
      const lines = section(mesh.voxel, triangles, plane.axis, at);
      context.beginPath();
      for (let n = 0; n + 3 < lines.length; n += 4) {
        context.moveTo(lines[n]!, lines[n + 1]!);
        context.lineTo(lines[n + 2]!, lines[n + 3]!);
      }
      context.lineCap = "round";
      context.lineWidth = width * 2;
      context.strokeStyle = "rgba(0, 0, 0, 0.55)";
      context.stroke();
      context.lineWidth = width;
      context.strokeStyle = colour[wall.name];
      context.stroke();
    }
  }

  /** Where the other planes cut this one. */
  private drawCross(context: CanvasRenderingContext2D, plane: Plane, width: number): void {
    const at = [this.centre[0], this.centre[1], this.slice];
    const { dims } = this.grid;
    context.strokeStyle = "rgba(255, 255, 255, 0.4)";
    context.lineWidth = width;
    context.setLineDash([4 * width, 4 * width]);
    context.beginPath();
    if (plane.axis === 2) {
      context.moveTo(at[0]!, -0.5);
      context.lineTo(at[0]!, dims[1] - 0.5);
    }
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
    const name = (sign: 1 | -1) => (plane.upwards ? (sign === 1 ? "Base" : "Apex") : orientation(this.grid, plane.y, sign));
    context.fillText(name(up), width / 2, 11);
    context.fillText(name(-up as 1 | -1), width / 2, height - 10);
  }
}
