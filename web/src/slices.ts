// Every slice of the gate that the beat is at, with what was found on it: all short-axis slices as tiles, one of them
// large, and two cuts along the heart. All three planes go through the cursor.
import type { Cursor, Voxel } from "./cursor";
import { html } from "./dom";
import { type Drawing, Painter, Plane } from "./painter";
import { say } from "./words";

/** Something that draws over the slices and may take the pointer from the cursor. */
export interface Tool {
  over(plane: Plane, at: number): Drawing | undefined;
  /** Whether it takes a pointer that goes down at a place of a plane; `mm`: of a pixel of the page. */
  down(plane: Plane, at: number, place: [number, number], mm: number): boolean;
  move(place: [number, number]): void;
  up(): void;
  /** The pointer's look there, empty: as always. */
  pointer(plane: Plane, at: number, place: [number, number], mm: number): string;
}

export class Slices {
  gate = 0;
  tool: Tool | null = null;
  private lit = 0;
  private readonly tiles: { button: HTMLButtonElement; canvas: HTMLCanvasElement }[] = [];
  private readonly sheet = html("div", { class: "tiles", role: "group", "aria-label": say("All slices, apex first") });
  private readonly large = html("canvas", { class: "large", role: "img" });
  private readonly long = html("div", { class: "long" });
  private readonly cuts: { plane: Plane; canvas: HTMLCanvasElement }[];
  private readonly caption = html("p", { class: "caption", "aria-live": "polite" });
  private readonly slider: HTMLInputElement;

  /** `point` is told the segment under the pointer, 0: none. */
  constructor(
    place: HTMLElement,
    private readonly painter: Painter,
    private readonly cursor: Cursor,
    private readonly point: (segment: number) => void,
  ) {
    const { dims } = painter.grid;
    this.slider = html("input", { type: "range", min: 1, max: dims[2], step: 1, "aria-label": say("Slice, 1 is the apex") });
    this.slider.addEventListener("input", () => this.choose(this.slider.valueAsNumber - 1));
    this.cuts = ([1, 0] as const).map((axis) => ({
      plane: new Plane(axis),
      canvas: html("canvas", { class: "cut", role: "img" }),
    }));
    this.build(place);
    new ResizeObserver(() => this.layOut()).observe(this.large);
    cursor.listen(() => this.draw());
  }

  get slice(): number {
    return this.cursor.at[2];
  }

  choose(slice: number): void {
    this.cursor.move([this.cursor.at[0], this.cursor.at[1], slice]);
  }

  private build(place: HTMLElement): void {
    for (let k = 0; k < this.painter.grid.dims[2]; ++k) {
      const canvas = html("canvas", {});
      const button = html("button", { class: "tile", "aria-label": say("Slice {slice}", { slice: k + 1 }) }, canvas, html("span", {}, String(k + 1)));
      button.addEventListener("click", () => this.choose(k));
      this.sheet.append(button);
      this.tiles.push({ button, canvas });
    }
    const short = new Plane(2);
    const canvases = [
      ...this.tiles.map(({ canvas }, k) => ({ canvas, plane: short, at: () => k })),
      { canvas: this.large, plane: short, at: () => this.slice },
      ...this.cuts.map(({ canvas, plane }) => ({ canvas, plane, at: () => this.cursor.at[plane.axis] })),
    ];
    for (const { canvas, plane, at } of canvases) {
      canvas.addEventListener("pointermove", (event) => this.point(this.painter.segmentNear(this.voxelAt(canvas, plane, at(), event), this.gate)));
      canvas.addEventListener("pointerleave", () => this.point(0));
    }
    for (const { canvas, plane, at } of canvases.slice(this.tiles.length)) {
      const follow = (event: PointerEvent) => this.cursor.move(this.voxelAt(canvas, plane, at(), event));
      let taken = false;
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        const { place, mm } = this.painter.placeAt(plane, canvas, event);
        taken = this.tool?.down(plane, at(), place, mm) ?? false;
        if (!taken) follow(event);
      });
      canvas.addEventListener("pointermove", (event) => {
        const { place, mm } = this.painter.placeAt(plane, canvas, event);
        canvas.style.cursor = this.tool?.pointer(plane, at(), place, mm) ?? "";
        if (!(event.buttons & 1)) return;
        if (taken) this.tool!.move(place);
        else follow(event);
      });
      for (const end of ["pointerup", "pointercancel"])
        canvas.addEventListener(end, () => {
          if (taken) this.tool!.up();
          taken = false;
        });
    }
    this.long.append(...this.cuts.map(({ canvas }) => canvas));
    place.replaceChildren(
      html("div", { class: "short" }, this.large, html("div", { class: "under" }, this.slider, this.caption)),
      this.long,
      this.sheet,
    );
  }

  private voxelAt(canvas: HTMLCanvasElement, plane: Plane, at: number, event: PointerEvent): Voxel {
    const [x, y] = this.painter.voxelAt(plane, canvas, event);
    const voxel: Voxel = [0, 0, 0];
    voxel[plane.axis] = at;
    voxel[plane.x] = x;
    voxel[plane.y] = y;
    return voxel;
  }

  /** Lights a segment, 0: none. */
  light(segment: number): void {
    if (segment === this.lit) return;
    this.lit = segment;
    this.draw();
  }

  /** Gives all parts their shapes, then draws. */
  layOut(): void {
    for (const { plane, canvas } of this.cuts) {
      const frame = this.painter.frameOf(plane);
      const [dx, dy] = [this.painter.grid.spacing_mm[plane.x]!, this.painter.grid.spacing_mm[plane.y]!];
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

  private paint(canvas: HTMLCanvasElement, plane: Plane, at: number, rich: boolean): void {
    this.painter.paint(canvas, {
      plane,
      at,
      gate: this.gate,
      segment: this.lit,
      width: rich ? 1.8 : 1.1,
      letters: rich,
      cross: rich ? this.cursor.at : null,
      ...(rich && this.tool ? { over: this.tool.over(plane, at) } : {}),
    });
  }

  draw(): void {
    const labels = this.painter.pictures.labels[this.gate];
    const short = new Plane(2);
    this.tiles.forEach(({ button, canvas }, k) => {
      this.paint(canvas, short, k, false);
      button.setAttribute("aria-pressed", String(k === this.slice));
      button.classList.toggle("found", labels?.base_slice === k || labels?.division_slice === k);
      button.title = [
        say("Slice {slice}", { slice: k + 1 }),
        labels?.division_slice === k ? say("division slice: one border below, two above") : "",
        labels?.base_slice === k ? say("highest slice of the ventricle") : "",
        labels?.big_slice === k ? say("widest border") : "",
      ].filter(Boolean).join(", ");
    });
    this.paint(this.large, short, this.slice, true);
    this.large.setAttribute("aria-label", say("Short-axis slice {slice}, gate {gate}", { slice: this.slice + 1, gate: this.gate + 1 }));
    for (const { plane, canvas } of this.cuts) {
      const at = this.cursor.at[plane.axis];
      this.paint(canvas, plane, at, true);
      const name = plane.axis === 1 ? say("row {n}", { n: at + 1 }) : say("column {n}", { n: at + 1 });
      canvas.setAttribute("aria-label", say("Cut along the heart through {name}, gate {gate}, slice {slice} marked", { name, gate: this.gate + 1, slice: this.slice + 1 }));
    }
    this.slider.value = String(this.slice + 1);
    const count = this.painter.grid.dims[2];
    const words = [say("Slice {slice} of {count}", { slice: this.slice + 1, count })];
    if (this.slice === 0) words.push(say("apical end"));
    if (this.slice === count - 1) words.push(say("basal end"));
    if (labels?.division_slice === this.slice) words.push(say("division slice"));
    if (labels?.base_slice === this.slice) words.push(say("base of the ventricle"));
    this.caption.textContent = words.join(" · ");
  }
}
