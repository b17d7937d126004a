// How a level grows out of the next coarser one.
import { unpack } from "../data";

export interface PackedTransition {
  cuts: string;
  triangles: string;
  start: string;
}

/** A level's triangles cut so that at its start they are the coarser level's very shape. */
export interface Transition {
  cuts: Uint32Array; // two ends for each vertex beyond the level's own: it stands half way between them
  triangles: Uint32Array;
  start: Float32Array; // places of all vertices on the coarser level
}

export async function readTransition(packed: PackedTransition, place: (packed: string) => Promise<Float32Array>): Promise<Transition> {
  const whole = async (text: string) => new Uint32Array((await unpack(text)).buffer);
  return { cuts: await whole(packed.cuts), triangles: await whole(packed.triangles), start: await place(packed.start) };
}

/** Values of the level's own vertices, `size` each, and those between. */
export function withCuts(values: Float32Array, cuts: Uint32Array, size: number): Float32Array {
  const all = new Float32Array(values.length + (cuts.length / 2) * size);
  all.set(values);
  for (let n = 0; n < cuts.length / 2; ++n)
    for (let k = 0; k < size; ++k) all[values.length + n * size + k] = (all[cuts[2 * n]! * size + k]! + all[cuts[2 * n + 1]! * size + k]!) / 2;
  return all;
}
