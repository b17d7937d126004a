// What the particles moved in: the voxels of the border, the field and the drag around it, read and put into a scene.
import { BoxGeometry, BufferGeometry, Color, Float32BufferAttribute, InstancedMesh, LineBasicMaterial, LineSegments, Matrix4, MeshPhongMaterial } from "three";

import { toWorld, type Voxel } from "./cursor";
import type { Around, Grid } from "./data";
import { evenColour } from "./polar";

/** A field is followed in steps of half a voxel, so many of them at most. */
const longest_line = 120;

/** The field at a place in voxels of the study, between the voxels trilinear; null outside. */
export function vectorAt({ first, dims, vectors }: Around, place: readonly number[]): Voxel | null {
  const at = place.map((v, axis) => v - first[axis]!);
  if (at.some((v, axis) => v < 0 || v > dims[axis]! - 1)) return null;
  const low = at.map((v, axis) => Math.min(Math.floor(v), Math.max(dims[axis]! - 2, 0)));
  const sum: Voxel = [0, 0, 0];
  for (let corner = 0; corner < 8; ++corner) {
    let weight = 1;
    const voxel = low.map((v, axis) => {
      const upper = (corner >> axis) & 1;
      const share = at[axis]! - v;
      weight *= upper ? share : 1 - share;
      return Math.min(v + upper, dims[axis]! - 1);
    });
    if (weight === 0) continue;
    const n = voxel[0]! + dims[0] * (voxel[1]! + dims[1] * voxel[2]!);
    for (let axis = 0; axis < 3; ++axis) sum[axis]! += weight * vectors[3 * n + axis]!;
  }
  return sum;
}

/** Calls visit(voxel of the study, number) for every voxel. */
export function eachVoxel({ first, dims }: Around, visit: (voxel: Voxel, n: number) => void): void {
  let n = 0;
  for (let k = 0; k < dims[2]; ++k)
    for (let j = 0; j < dims[1]; ++j) for (let i = 0; i < dims[0]; ++i) visit([first[0] + i, first[1] + j, first[2] + k], n++);
}

/** The length that one of fifty vectors exceeds: the largest ones are few. */
export function usualLongest({ vectors }: Around): number {
  const lengths = new Float32Array(vectors.length / 3);
  for (let n = 0; n < lengths.length; ++n) lengths[n] = Math.hypot(vectors[3 * n]!, vectors[3 * n + 1]!, vectors[3 * n + 2]!);
  lengths.sort();
  return Math.max(lengths[Math.floor((lengths.length * 49) / 50)] ?? 0, 1e-12);
}

/** A line that follows the field until it turns back: there it has reached a border. In voxels of the study. */
export function follow(around: Around, start: Voxel, { spacing_mm }: Grid): { place: Voxel; length: number }[] {
  const step = 0.5 * Math.min(...spacing_mm);
  const line: { place: Voxel; length: number }[] = [];
  let at = start;
  let before: Voxel = [0, 0, 0];
  for (let n = 0; n < longest_line; ++n) {
    const v = vectorAt(around, at);
    const length = v ? Math.hypot(...v) : 0;
    if (!v || length < 1e-12) break;
    line.push({ place: at, length });
    const way = v.map((part) => part / length) as Voxel;
    if (way[0] * before[0] + way[1] * before[1] + way[2] * before[2] < 0) break;
    at = at.map((place, axis) => place + (step * way[axis]!) / spacing_mm[axis]!) as Voxel;
    before = way;
  }
  return line;
}

function cubes(places: Voxel[], grid: Grid, fill: number, opacity: number): InstancedMesh {
  const look = new MeshPhongMaterial({ color: 0xffffff, transparent: opacity < 1, opacity, depthWrite: opacity === 1 });
  const mesh = new InstancedMesh(new BoxGeometry(fill, fill, fill), look, places.length);
  const { direction: d, spacing_mm: s } = grid;
  places.forEach((voxel, n) => {
    const [x, y, z] = toWorld(grid, voxel);
    const row = (r: number) => [d[3 * r]! * s[0], d[3 * r + 1]! * s[1], d[3 * r + 2]! * s[2]] as const;
    mesh.setMatrixAt(n, new Matrix4().set(...row(0), x, ...row(1), y, ...row(2), z, 0, 0, 0, 1));
  });
  mesh.frustumCulled = false;
  return mesh;
}

/** The voxels of the border. */
export function borderCubes(around: Around, grid: Grid, colour: string, opacity: number): InstancedMesh {
  const places: Voxel[] = [];
  eachVoxel(around, (voxel, n) => around.border[n] === 1 && places.push(voxel));
  const mesh = cubes(places, grid, 0.9, opacity);
  places.forEach((_, n) => mesh.setColorAt(n, new Color(colour)));
  return mesh;
}

/** The voxels with more than a quarter of the largest drag, their far half: cut open. */
export function dragCubes(around: Around, grid: Grid): InstancedMesh | null {
  if (!around.drag) return null;
  const { values } = around.drag;
  const places: Voxel[] = [];
  const shares: number[] = [];
  eachVoxel(around, (voxel, n) => {
    if (values[n]! < 64 || voxel[1] < around.first[1] + around.dims[1] / 2) return;
    places.push(voxel);
    shares.push(values[n]! / 255);
  });
  const mesh = cubes(places, grid, 0.8, 1);
  shares.forEach((share, n) => mesh.setColorAt(n, new Color(evenColour((share - 0.25) / 0.75))));
  return mesh;
}

/** Lines that follow the field from an ellipsoid around the border, coloured by the field's length. */
export function fieldLines(around: Around, grid: Grid): LineSegments {
  const [low, high]: [Voxel, Voxel] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  eachVoxel(around, (voxel, n) => {
    if (around.border[n] !== 1) return;
    for (let axis = 0; axis < 3; ++axis) {
      low[axis] = Math.min(low[axis]!, voxel[axis]!);
      high[axis] = Math.max(high[axis]!, voxel[axis]!);
    }
  });
  const middle = low.map((v, axis) => (v + high[axis]!) / 2);
  const half = low.map((v, axis) => (high[axis]! - v) / 2 + 3);
  const longest = usualLongest(around);
  const places: number[] = [];
  const colours: number[] = [];
  for (let ring = -2; ring <= 2; ++ring)
    for (let n = 0; n < 24; ++n) {
      const angle = (2 * Math.PI * n) / 24;
      const start: Voxel = [middle[0]! + half[0]! * Math.cos(angle), middle[1]! + half[1]! * Math.sin(angle), middle[2]! + 0.45 * ring * half[2]!];
      const line = follow(around, start, grid);
      for (let m = 1; m < line.length; ++m)
        for (const { place, length } of [line[m - 1]!, line[m]!]) {
          places.push(...toWorld(grid, place));
          const { r, g, b } = new Color(evenColour(length / longest));
          colours.push(r, g, b);
        }
    }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(places, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true }));
  lines.frustumCulled = false;
  return lines;
}
