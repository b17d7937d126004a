// What the fit saw, what it made of it and what it left, in the slice and the cut that the cursor is in.
import { toWorld, type Cursor, type Voxel } from "./cursor";
import type { Wall } from "./cycle";
import { toVoxels, type Fit, type Grid } from "./data";
import { figure, html } from "./dom";
import { Painter, Plane } from "./painter";
import { say } from "./words";

// Dark where the image is as the model, blue where it is darker, orange where it is brighter: told apart by everyone.
const less = [90, 169, 255] as const;
const more = [255, 150, 70] as const;

/** Colours of the differences -127 to 127. */
function differencePalette(): Uint8Array {
  const palette = new Uint8Array(3 * 256);
  for (let byte = 0; byte < 256; ++byte) {
    const share = Math.max(-1, Math.min(1, (byte - 128) / 127));
    for (let c = 0; c < 3; ++c) palette[3 * byte + c] = Math.round(16 + Math.abs(share) * ((share < 0 ? less : more)[c]! - 16));
  }
  return palette;
}

interface Kind {
  name: string;
  about: string;
  painter: Painter;
}

export class Residuals {
  gate = 0;
  private readonly grid: Grid;
  private readonly kinds: Kind[];
  private readonly pictures: { canvas: HTMLCanvasElement; painter: Painter; plane: Plane }[] = [];
  private readonly caption = html("p", { class: "caption", "aria-live": "polite" });

  constructor(
    place: HTMLElement,
    private readonly fit: Fit,
    walls: Wall[],
    private readonly study: Grid,
    private readonly cursor: Cursor,
  ) {
    this.grid = fit.grid;
    const here = walls.map((wall) => wall.on(fit.grid));
    const { dims } = fit.grid;
    const gates = fit.model.length / (dims[0] * dims[1] * dims[2]);
    const painter = (pixels: Uint8Array, palette: Uint8Array | null = null) =>
      new Painter(
        { grid: fit.grid, bin: 1, columns: dims[0], rows: dims[1], gates: pixels === fit.weight ? 1 : gates, pixels, marked_gates: 0, marks: new Uint8Array(), labels: [] },
        here,
        null,
        palette,
      );
    const most = `${figure(100 * fit.most, 0)} %`;
    this.kinds = [
      { name: say("Data"), about: say("as the fit saw it"), painter: painter(this.dataBytes()) },
      { name: say("Model"), about: say("the fitted heart through the point spread"), painter: painter(fit.model) },
      { name: say("Data − model"), about: say("blue −{most}, orange +{most} of healthy muscle", { most }), painter: painter(fit.difference, differencePalette()) },
      { name: say("Weight"), about: say("one over the variance; black: not used"), painter: painter(fit.weight) },
    ];
    place.replaceChildren(html("div", { class: "residuals" }, ...this.kinds.map((kind) => this.column(kind))), this.caption);
    new ResizeObserver(() => this.draw()).observe(place);
    cursor.listen(() => this.draw());
  }

  /** The model and what differs from it, in the model's scale. */
  private dataBytes(): Uint8Array {
    const { model, difference, low, high, most } = this.fit;
    const step = ((most / 127) * 255) / (high - low || 1);
    return model.map((byte, n) => Math.min(255, Math.max(0, Math.round(byte + (difference[n]! - 128) * step))));
  }

  private column({ name, about, painter }: Kind): HTMLElement {
    const canvases = [new Plane(2), new Plane(1)].map((plane) => {
      const canvas = html("canvas", { role: "img" });
      const frame = painter.frameOf(plane, false);
      const { spacing_mm } = this.grid;
      canvas.style.aspectRatio = String(((frame.x1 - frame.x0) * spacing_mm[plane.x]!) / ((frame.y1 - frame.y0) * spacing_mm[plane.y]!));
      this.pictures.push({ canvas, painter, plane });
      return canvas;
    });
    return html("figure", {}, html("figcaption", {}, html("b", {}, name), " ", about), ...canvases);
  }

  /** The pixel of the fit that the cursor is in; may lie outside. */
  private at(): Voxel {
    return [...toVoxels(this.grid, new Float32Array(toWorld(this.study, this.cursor.at)))].map(Math.round) as Voxel;
  }

  /** Root mean square of the difference in a slice of the gate, in parts of healthy muscle; null: nothing is looked at. */
  private rmsOf(slice: number): number | null {
    const { dims } = this.grid;
    const size = dims[0] * dims[1];
    const start = (this.gate * dims[2] + slice) * size;
    let [squares, count] = [0, 0];
    for (let n = 0; n < size; ++n) {
      if (this.fit.weight[slice * size + n] === 0) continue;
      squares += (((this.fit.difference[start + n]! - 128) * this.fit.most) / 127) ** 2;
      ++count;
    }
    return count > 0 ? Math.sqrt(squares / count) : null;
  }

  draw(): void {
    const at = this.at();
    const inside = at.every((v, axis) => v >= 0 && v < this.grid.dims[axis]!);
    const shown = at.map((v, axis) => Math.min(Math.max(v, 0), this.grid.dims[axis]! - 1)) as Voxel;
    const here = { slice: this.cursor.at[2] + 1, gate: this.gate + 1 };
    for (const { canvas, painter, plane } of this.pictures) {
      painter.paint(canvas, { plane, at: shown[plane.axis], gate: this.gate, segment: 0, width: 1.2, letters: false, cross: null, splash: true });
      canvas.setAttribute("aria-label", plane.axis === 2 ? say("Slice {slice}, gate {gate}", here) : say("Cut along the heart, gate {gate}", here));
    }
    const rms = this.rmsOf(shown[2]);
    const words = [
      say("Gate {gate}, slice {slice}", here),
      inside ? "" : say("the fit does not look there: the nearest slice is shown"),
      rms === null
        ? ""
        : say("difference here {n} %, in all gates and slices {all} % of healthy muscle (root mean square)", {
            n: figure(100 * rms),
            all: figure(100 * this.fit.rms),
          }),
    ];
    this.caption.textContent = words.filter(Boolean).join(" · ");
  }
}
