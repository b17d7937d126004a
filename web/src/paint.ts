// Paint over the voxels of the study: 1 where a person says that nothing is to be looked at.
import type { Voxel } from "./cursor";
import type { Grid } from "./data";
import type { Plane } from "./painter";

const ink = "rgba(255, 60, 90, 0.45)";

/** Paints, or takes paint away, within so many mm of a place in voxels. */
export function brushOver(paint: Uint8Array, { dims, spacing_mm }: Grid, middle: Voxel, radius_mm: number, is_paint: boolean): void {
  const low = middle.map((m, n) => Math.max(Math.ceil(m - radius_mm / spacing_mm[n]!), 0));
  const high = middle.map((m, n) => Math.min(Math.floor(m + radius_mm / spacing_mm[n]!), dims[n]! - 1));
  for (let k = low[2]!; k <= high[2]!; ++k)
    for (let j = low[1]!; j <= high[1]!; ++j)
      for (let i = low[0]!; i <= high[0]!; ++i) {
        const far = Math.hypot((i - middle[0]) * spacing_mm[0], (j - middle[1]) * spacing_mm[1], (k - middle[2]) * spacing_mm[2]);
        if (far <= radius_mm) paint[i + dims[0] * (j + dims[1] * k)] = is_paint ? 1 : 0;
      }
}

export function drawPaint(context: CanvasRenderingContext2D, paint: Uint8Array, { dims }: Grid, plane: Plane, at: number): void {
  const strides = [1, dims[0], dims[0] * dims[1]];
  context.fillStyle = ink;
  for (let y = 0; y < dims[plane.y]!; ++y)
    for (let x = 0; x < dims[plane.x]!; ++x)
      if (paint[at * strides[plane.axis]! + x * strides[plane.x]! + y * strides[plane.y]!]) context.fillRect(x - 0.5, y - 0.5, 1, 1);
}
