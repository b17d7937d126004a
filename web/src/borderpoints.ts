// Points of the borders that a person places: the walls of the next fit go through them.
import { toWorld, type Voxel } from "./cursor";
import type { Section } from "./cycle";
import { toVoxels, type Grid, type WallName } from "./data";
import { colour } from "./dom";
import { type Painter, type View, voxelIn } from "./painter";

/** A point of one gate, from 1, in the world. */
export interface BorderPoint {
  wall: WallName;
  gate: number;
  place_mm: Voxel;
}

/** The options of the program hold gate,x,y,z of every point, one after the other. */
export const numbersOf = (points: BorderPoint[], wall: WallName): number[] =>
  points.filter((point) => point.wall === wall).flatMap(({ gate, place_mm }) => [gate, ...place_mm]);
export function pointsIn(numbers: number[], wall: WallName): BorderPoint[] {
  const points: BorderPoint[] = [];
  for (let n = 0; n + 3 < numbers.length; n += 4)
    points.push({ wall, gate: numbers[n]!, place_mm: [numbers[n + 1]!, numbers[n + 2]!, numbers[n + 3]!] });
  return points;
}

/** A plane of a gate, from 0. */
type Place = Pick<View, "plane" | "at" | "gate">;

/** The points in the slice that a plane shows, and where they are there. */
export function pointsOn(grid: Grid, points: BorderPoint[], { plane, at, gate }: Place): { point: BorderPoint; place: [number, number] }[] {
  return points
    .filter((point) => point.gate === gate + 1)
    .map((point) => ({ point, voxel: [...toVoxels(grid, new Float32Array(point.place_mm))] }))
    .filter(({ voxel }) => Math.abs(voxel[plane.axis]! - at) <= 0.5)
    .map(({ point, voxel }) => ({ point, place: [voxel[plane.x]!, voxel[plane.y]!] }));
}

/** Distance in mm of a place in a plane from a cut through a wall. */
export function distanceFrom(cut: Section, [x, y]: [number, number], [dx, dy]: [number, number]): number {
  let best = Infinity;
  for (let n = 0; n < cut.lines.length; n += 4) {
    const [ax, ay, bx, by] = [0, 1, 2, 3].map((k) => (cut.lines[n + k]! - (k % 2 ? y : x)) * (k % 2 ? dy : dx)) as [number, number, number, number];
    const [ux, uy] = [bx - ax, by - ay];
    const share = Math.min(Math.max(-(ax * ux + ay * uy) / (ux * ux + uy * uy || 1), 0), 1);
    best = Math.min(best, Math.hypot(ax + share * ux, ay + share * uy));
  }
  return best;
}

/** A diamond in the colour of its wall; `flat`: so much higher than wide a voxel is. */
export function drawPoint(context: CanvasRenderingContext2D, [x, y]: [number, number], wall: WallName, pixel: number, flat: number): void {
  const [w, h] = [7 * pixel, 7 * pixel * flat];
  context.beginPath();
  context.moveTo(x - w, y);
  context.lineTo(x, y - h);
  context.lineTo(x + w, y);
  context.lineTo(x, y + h);
  context.closePath();
  context.fillStyle = colour[wall];
  context.fill();
  context.lineWidth = 2 * pixel;
  context.strokeStyle = "#fff";
  context.stroke();
}

/** What a pointer does from its way down on; `still`: where it goes up without having moved. */
export interface Drag {
  move: (place: [number, number]) => void;
  still?: () => void;
  has_moved?: boolean;
}

/** Moves the point within reach, else a new one of the border within reach; a point that is not moved is taken back. */
export function borderDrag(
  painter: Painter,
  points: BorderPoint[],
  here: Place,
  place: [number, number],
  reach_mm: number,
  set: (points: BorderPoint[]) => void,
): Drag | null {
  const { grid } = painter;
  const { plane, at, gate } = here;
  const scale: [number, number] = [grid.spacing_mm[plane.x]!, grid.spacing_mm[plane.y]!];
  const far = ([x, y]: [number, number]) => Math.hypot((x - place[0]) * scale[0], (y - place[1]) * scale[1]);
  const old = pointsOn(grid, points, here).find((there) => far(there.place) < reach_mm)?.point;
  const nearest = painter.walls
    .map((wall) => ({ name: wall.name, cut: painter.sectionOf(wall, here) }))
    .map(({ name, cut }) => ({ name, far: cut ? distanceFrom(cut, place, scale) : Infinity }))
    .sort((a, b) => a.far - b.far)[0];
  const wall = old?.wall ?? (nearest && nearest.far < reach_mm ? nearest.name : null);
  if (!wall) return null;
  const others = points.filter((point) => !old || JSON.stringify(point) !== JSON.stringify(old));
  const moved = (to: [number, number]): BorderPoint => ({ wall, gate: gate + 1, place_mm: toWorld(grid, voxelIn(plane, at, to, grid)) });
  return { move: (to) => set([...others, moved(to)]), still: () => set(others) };
}
