// The one place in the heart that every picture marks. Whoever points at a place moves it.
import type { Grid, Mesh, Polar } from "./data";

export type Voxel = [number, number, number];

export class Cursor {
  at: Voxel;
  private readonly listeners: ((at: Voxel) => void)[] = [];

  constructor(
    private readonly dims: Voxel,
    at: Voxel,
  ) {
    this.at = at;
  }

  listen(listener: (at: Voxel) => void): void {
    this.listeners.push(listener);
    listener(this.at);
  }

  /** Goes to the voxel nearest to a place, inside the stack. */
  move(to: ArrayLike<number>): void {
    const at = this.dims.map((count, axis) => Math.min(Math.max(Math.round(to[axis]!), 0), count - 1)) as Voxel;
    if (at.every((v, axis) => v === this.at[axis])) return;
    this.at = at;
    for (const listener of this.listeners) listener(at);
  }
}

/** The world position (LPS, mm) of a place in voxels. */
export function toWorld({ origin_mm, spacing_mm, direction }: Grid, voxel: readonly number[]): Voxel {
  return [0, 1, 2].map((row) =>
    [0, 1, 2].reduce((sum, axis) => sum + direction[3 * row + axis]! * spacing_mm[axis]! * voxel[axis]!, origin_mm[row]!),
  ) as Voxel;
}

const no_sample = 65535;

/** The sample of the polar maps at a vertex of the endocardium of a gate, -1: none. */
function sampleAt(samples: Uint8Array, vertex: number): number {
  const sample = samples[2 * vertex]! + 256 * samples[2 * vertex + 1]!;
  return sample === no_sample ? -1 : sample;
}

/** The vertex with a sample for which `distance` is least, -1: none has one. */
function nearestVertex(samples: Uint8Array, distance: (vertex: number, sample: number) => number): number {
  let [best, found] = [Infinity, -1];
  for (let v = 0; 2 * v < samples.length; ++v) {
    const sample = sampleAt(samples, v);
    if (sample < 0) continue;
    const far = distance(v, sample);
    if (far < best) [best, found] = [far, v];
  }
  return found;
}

/** The sample of the polar maps nearest to a place in voxels, -1: none. */
export function sampleNear(samples: Uint8Array, { voxel }: Mesh, { spacing_mm }: Grid, at: Voxel): number {
  const vertex = nearestVertex(samples, (v) =>
    [0, 1, 2].reduce((sum, axis) => sum + ((voxel[3 * v + axis]! - at[axis]!) * spacing_mm[axis]!) ** 2, 0),
  );
  return vertex < 0 ? -1 : sampleAt(samples, vertex);
}

/** Where on a polar map the middle of a sample lies: part of the radius, degrees counter-clockwise from the right. */
export function placeOnMap({ rings, sectors }: Polar, sample: number): { rho: number; deg: number } {
  return { rho: (Math.floor(sample / sectors) + 0.5) / rings, deg: (((sample % sectors) + 0.5) * 360) / sectors };
}

/** The place in voxels on the endocardium that is nearest to one on the polar map, null: there is none. */
export function placeInHeart(polar: Polar, samples: Uint8Array, { voxel }: Mesh, rho: number, deg: number): Voxel | null {
  const onMap = (r: number, d: number) => [r * Math.cos((d * Math.PI) / 180), r * Math.sin((d * Math.PI) / 180)] as const;
  const [x, y] = onMap(rho, deg);
  const vertex = nearestVertex(samples, (_, sample) => {
    const place = placeOnMap(polar, sample);
    const [px, py] = onMap(place.rho, place.deg);
    return (px - x) ** 2 + (py - y) ** 2;
  });
  return vertex < 0 ? null : [voxel[3 * vertex]!, voxel[3 * vertex + 1]!, voxel[3 * vertex + 2]!];
}
