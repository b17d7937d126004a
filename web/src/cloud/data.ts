// What the program wrote into the page of a cloud, and how it becomes arrays.
import { readTransition, withCuts, type PackedTransition, type Transition } from "../lod/transition";
import { unpack, type NoteText, type Results } from "../data";

interface Distance {
  mean: number | null;
  largest: number | null;
  mean_percent: number | null;
  largest_percent: number | null;
}
export interface Certificate {
  watertight: boolean;
  closed: boolean;
  manifold: boolean;
  oriented: boolean;
  outward: boolean;
  self_intersections: number;
  flat_triangles: number;
  components: number;
  boundary_loops: number;
  genus: number | null;
  angles_deg: { smallest: number | null; percentile_1: number | null; percentile_5: number | null; mean: number | null };
  distances: { cloud_to_mesh: Distance; mesh_to_cloud: Distance };
  volume: number | null;
  area: number | null;
}
export interface LevelNumbers {
  level: number;
  name: string;
  triangles_asked: number;
  triangles: number;
  vertices: number;
  share_of_plain_tessellation_percent: number | null;
  certificate: Certificate;
}
export interface CloudResults extends Pick<Results, "provenance" | "timings_s" | "schema"> {
  verdict: "ok" | "check" | "fail";
  boundary: "close" | "keep" | "trim";
  watertight: boolean;
  levels: LevelNumbers[];
  cloud: {
    files: { format: string; points: number; triangles: number }[];
    points: number;
    not_finite: number;
    duplicates: number;
    outliers: number;
    points_used: number;
    has_normals: boolean;
    has_colours: boolean;
    scans: number;
    diagonal: number | null;
    spacing: number | null;
    noise: number | null;
    cells: number;
    parts: number;
    genus: number;
    boundary_loops: number;
  };
  support: {
    within: number | null;
    points_off_percent: number | null;
    points_off_mean_ratio: number | null;
    points_left_out_percent: number | null;
    biased_percent: number | null;
    made_up_percent: number | null;
    made_up_largest_percent: number | null;
    unfaced_points: number | null;
    turned_percent: number | null;
    thin_percent: number | null;
    gaps_percent: number | null;
    firm_percent: number | null;
  };
  notes: NoteText[];
}

/** Whether a level is what it should be: watertight, or sound and open where the surface was left open. */
export function isSound(results: CloudResults, { certificate: c }: LevelNumbers): boolean {
  if (results.boundary === "close") return c.watertight;
  return c.boundary_loops > 0 && c.manifold && c.oriented && c.self_intersections === 0 && c.flat_triangles === 0;
}

interface Packed {
  results: CloudResults;
  low: number[];
  high: number[];
  cloud: { shown: number; positions: string; colours: string | null };
  levels: { positions: string; triangles: string; errors: string; confidence: string | null; colours: string | null }[];
  full_error: number;
  transitions: (PackedTransition | null)[];
}

/** A surface: vertices around the middle of the scene, three numbers each. */
export interface Level {
  numbers: LevelNumbers;
  positions: Float32Array;
  triangles: Uint32Array;
  errors: Float32Array; // in the cloud's unit; -1 where nothing can be said
  confidence: Float32Array; // 1 where the points support the surface, below where it is made up
  colours: Uint8Array | null;
  start: Float32Array | null; // where each vertex stands on the next level
  growing: Level | null; // the level to draw while it grows out of the next: the same shape, cut to begin with that one
}
export interface CloudReport {
  results: CloudResults;
  radius: number;
  points: { positions: Float32Array; colours: Uint8Array | null };
  levels: Level[];
  full_error: number;
}

async function stepsOf(text: string): Promise<Uint16Array> {
  return new Uint16Array((await unpack(text)).buffer);
}

function grown(level: Level, { cuts, triangles, start }: Transition): Level {
  const positions = withCuts(level.positions, cuts, 3), errors = withCuts(level.errors, cuts, 1);
  const confidence = withCuts(level.confidence, cuts, 1);
  const colours = level.colours && Uint8Array.from(withCuts(Float32Array.from(level.colours), cuts, 3));
  return { ...level, positions, triangles, errors, confidence, colours, start };
}

/** Of the ball around the middle that holds all places. */
function radiusOf(all: Float32Array[]): number {
  let largest = 0;
  for (const places of all)
    for (let n = 0; n < places.length; n += 3) largest = Math.max(largest, Math.hypot(places[n]!, places[n + 1]!, places[n + 2]!));
  return largest;
}

export async function readCloudReport(text: string): Promise<CloudReport> {
  const data = JSON.parse(text) as Packed;
  const middle = data.low.map((low, axis) => (low + data.high[axis]!) / 2);
  const side = data.low.map((low, axis) => data.high[axis]! - low);
  const place = async (packed: string) => {
    const steps = await stepsOf(packed);
    const places = new Float32Array(steps.length);
    for (let n = 0; n < steps.length; ++n) {
      const axis = n % 3;
      places[n] = data.low[axis]! - middle[axis]! + (side[axis]! * steps[n]!) / 65535;
    }
    return places;
  };
  const levels = await Promise.all(
    data.levels.map(async (packed, n) => {
      const errors = Float32Array.from(await stepsOf(packed.errors), (e) => (e === 65535 ? -1 : (e / 65534) * data.full_error));
      const level: Level = {
        numbers: data.results.levels[n]!,
        positions: await place(packed.positions),
        triangles: new Uint32Array((await unpack(packed.triangles)).buffer),
        errors,
        confidence: packed.confidence ? Float32Array.from(await stepsOf(packed.confidence), (c) => c / 65535) : new Float32Array(errors.length).fill(1),
        colours: packed.colours ? await unpack(packed.colours) : null,
        start: null,
        growing: null,
      };
      const transition = data.transitions[n];
      if (transition) level.growing = grown(level, await readTransition(transition, place));
      return level;
    }),
  );
  const points = await place(data.cloud.positions);
  return {
    results: data.results,
    radius: radiusOf([points, ...levels.map((level) => level.positions)]) || 1,
    points: { positions: points, colours: data.cloud.colours ? await unpack(data.cloud.colours) : null },
    levels,
    full_error: data.full_error,
  };
}

