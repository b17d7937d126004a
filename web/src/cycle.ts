// The beat between its gates: the same periodic cubic spline as the program's keyframes.
import { toVoxels, type Grid, type Mesh, type Surfaces, type WallName } from "./data";

/**
 * Weights of n gates at `phase`, counted in gates: the value there of the C2 spline through 1 at one gate and 0 at the
 * others, closed from the last to the first. Second derivatives solve M[i-1] + 4 M[i] + M[i+1] = 6 (y[i-1] - 2 y[i] +
 * y[i+1]), a circulant system, so a Fourier sum gives its inverse.
 */
export function splineWeights(n: number, phase: number): Float64Array {
  const weights = new Float64Array(n);
  const at = (i: number) => ((i % n) + n) % n;
  const first = Math.floor(phase);
  const u = phase - first;
  if (u === 0 || n === 1) {
    weights[at(first)] = 1;
    return weights;
  }
  const inverse = new Float64Array(n);
  for (let d = 0; d < n; ++d)
    for (let k = 0; k < n; ++k) {
      const angle = (2 * Math.PI * k) / n;
      inverse[d]! += Math.cos(angle * d) / (4 + 2 * Math.cos(angle)) / n;
    }
  const bend = (d: number) => 6 * (inverse[at(d + 1)]! - 2 * inverse[at(d)]! + inverse[at(d - 1)]!);
  const left = ((1 - u) ** 3 - (1 - u)) / 6;
  const right = (u ** 3 - u) / 6;
  for (let g = 0; g < n; ++g) weights[g] = left * bend(first - g) + right * bend(first + 1 - g);
  weights[at(first)]! += 1 - u;
  weights[at(first + 1)]! += u;
  return weights;
}

/** Signed volume in mL of a closed surface (Gauss). */
export function volumeMl(points: Float32Array, triangles: Uint32Array): number {
  let six = 0;
  const p = (vertex: number, axis: number) => points[3 * vertex + axis]!;
  for (let t = 0; t < triangles.length; t += 3) {
    const [a, b, c] = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!];
    six +=
      p(a, 0) * (p(b, 1) * p(c, 2) - p(b, 2) * p(c, 1)) +
      p(a, 1) * (p(b, 2) * p(c, 0) - p(b, 0) * p(c, 2)) +
      p(a, 2) * (p(b, 0) * p(c, 1) - p(b, 1) * p(c, 0));
  }
  return six / 6000;
}

/** One wall over the beat. */
export class Wall {
  readonly meshes: (Mesh | null)[];
  /** All gates have it with the same triangles, so it can move smoothly. */
  readonly smooth: boolean;
  private readonly buffer: Float32Array;

  constructor(
    readonly name: WallName,
    private readonly surfaces: Surfaces,
  ) {
    this.meshes = surfaces[name];
    const first = this.meshes[0];
    this.smooth = !!first && this.meshes.every((m) => m?.topology === first.topology);
    this.buffer = new Float32Array(first?.world.length ?? 0);
  }

  /** The same wall, its vertices counted in the voxels of another grid. */
  on(grid: Grid): Wall {
    const gates = this.meshes.map((mesh) => mesh && { ...mesh, voxel: toVoxels(grid, mesh.world) });
    return new Wall(this.name, { ...this.surfaces, [this.name]: gates });
  }

  get present(): boolean {
    return this.meshes.some((m) => m !== null);
  }

  /** Vertices and triangles to show at `phase`; the nearest gate when the wall cannot move smoothly. */
  at(phase: number): { points: Float32Array; triangles: Uint32Array } | null {
    const n = this.meshes.length;
    if (this.smooth && phase !== Math.round(phase)) {
      const weights = splineWeights(n, phase);
      this.buffer.fill(0);
      this.meshes.forEach((mesh, g) => {
        const world = mesh!.world;
        for (let i = 0; i < world.length; ++i) this.buffer[i]! += weights[g]! * world[i]!;
      });
      return { points: this.buffer, triangles: this.surfaces.triangles[this.meshes[0]!.topology]! };
    }
    const mesh = this.meshes[Math.round(phase) % n];
    return mesh ? { points: mesh.world, triangles: this.surfaces.triangles[mesh.topology]! } : null;
  }

  trianglesOf(gate: number): Uint32Array | null {
    const mesh = this.meshes[gate];
    return mesh ? this.surfaces.triangles[mesh.topology]! : null;
  }
}

/** Cut of a mesh: pairs of points, each given by the two other axes in order, and the first vertex of each one's triangle. */
export interface Section {
  lines: number[]; // x, y, x, y per piece
  vertices: number[]; // one per piece
}

/**
 * Cut of a mesh with the plane `axis = at` in voxels. A vertex on the plane counts as above it, so that no piece is
 * lost or drawn twice.
 */
export function section(voxel: Float32Array, triangles: Uint32Array, axis: number, at: number): Section {
  const [x, y] = [0, 1, 2].filter((a) => a !== axis) as [number, number];
  const lines: number[] = [];
  const vertices: number[] = [];
  for (let t = 0; t < triangles.length; t += 3) {
    const before = lines.length;
    for (let edge = 0; edge < 3; ++edge) {
      const p = 3 * triangles[t + edge]!;
      const q = 3 * triangles[t + ((edge + 1) % 3)]!;
      const above = voxel[p + axis]! - at;
      const below = voxel[q + axis]! - at;
      if (above >= 0 === below >= 0) continue;
      const share = above / (above - below);
      lines.push(voxel[p + x]! + share * (voxel[q + x]! - voxel[p + x]!));
      lines.push(voxel[p + y]! + share * (voxel[q + y]! - voxel[p + y]!));
    }
    if (lines.length > before) vertices.push(triangles[t]!);
  }
  return { lines, vertices };
}
