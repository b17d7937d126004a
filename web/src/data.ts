// What the program wrote into the page, and how it becomes arrays.

export type WallName = "endo" | "epi";
export const walls: readonly WallName[] = ["endo", "epi"];

export interface Triangles {
  count: number;
  shape_mean: number | null;
  shape_min: number | null;
  smallest_angle_deg: number | null;
}
export interface SurfaceNumbers {
  volume_ml: number | null;
  vertices: number;
  stop_reason: string;
  steps: number;
  stopped_fraction: number | null;
  within_one_voxel: number | null;
  mean_distance_mm: number | null;
  triangles: Triangles;
}
/** The surfaces that were deformed onto the edges of a gate. */
export interface EdgeNumbers {
  endo_ml: number | null;
  epi_ml: number | null;
  wall_ml: number | null;
  endo: SurfaceNumbers | null;
  epi: SurfaceNumbers | null;
}
/** The volumes of a gate in the reading that leads. */
export interface GateNumbers {
  gate: number;
  time_ms: number | null;
  endo_ml: number | null;
  endo_ml_90: Interval;
  epi_ml: number | null;
  epi_ml_90: Interval;
  wall_ml: number | null;
  base_plane?: { point_mm: [number, number, number] } | null;
  edge: EdgeNumbers;
}
export interface NoteText {
  severity: "info" | "warning" | "failure";
  code: string;
  message: string;
  gate?: number | null;
  slice?: number | null;
}
export interface SegmentNumbers {
  number: number;
  name: string;
  territory: string;
  wall_share_percent: number | null;
  perfusion_percent: number | null;
  thickness_ed_mm: number | null;
  thickness_es_mm: number | null;
  thickening_percent: number | null;
  count_thickening_percent: number | null;
  motion_mm: number | null;
  displacement_mm: number | null;
  area_strain_percent: number | null;
  phase_counts_deg: number | null;
  phase_motion_deg: number | null;
  phase_thickness_deg: number | null;
  perfusion_percent_90: Interval;
  thickness_ed_mm_90: Interval;
  thickness_es_mm_90: Interval;
  thickening_percent_90: Interval;
  motion_mm_90: Interval;
  displacement_mm_90: Interval;
  area_strain_percent_90: Interval;
  phase_motion_deg_90: Interval;
  phase_thickness_deg_90: Interval;
}
/** A periodic fit of the cavity's volume; times are parts of the beat. */
export interface FunctionNumbers {
  waves: number;
  edv_ml: number | null;
  esv_ml: number | null;
  ef_percent: number | null;
  residual_ml: number | null;
  peak_emptying_edv_per_s: number | null;
  peak_filling_edv_per_beat: number | null;
  peak_filling_edv_per_s: number | null;
  time_to_peak_filling: number | null;
  time_to_peak_filling_ms: number | null;
  first_third_filling: number | null;
  instants: { ef_percent: number | null };
  mean_ml: number;
  cosine_ml: number[];
  sine_ml: number[];
}
export interface PhaseNumbers {
  bin_deg: number;
  histogram_percent: number[];
  mean_deg: number;
  sd_deg: number;
  bandwidth_deg: number;
  entropy_percent: number;
}
export interface MeasureNumbers {
  /** Null: a blood pool, no wall is seen. */
  thickness_is: "apparent" | "model" | null;
  perfusion_is: "counts" | "uptake" | null;
  muscle_ml: number | null;
  muscle_g: number | null;
  function: FunctionNumbers | null;
  phase: { counts: PhaseNumbers | null; motion: PhaseNumbers | null; thickness: PhaseNumbers | null };
  segments: SegmentNumbers[];
}
export type Interval = [number | null, number | null] | null;
type WithIntervals<T> = T & { [K in keyof T & string as `${K}_90`]: Interval };
/** The beat in numbers, as one way of reading tells it. Gates count from 1. */
export type Reading = WithIntervals<{
  edv_ml: number | null;
  esv_ml: number | null;
  sv_ml: number | null;
  ef_percent: number | null;
  wall_ml: number | null;
}> & { ed_gate: number | null; es_gate: number | null };
/** At the top the reading that leads; its surfaces are those shown. */
export type Results = Reading & {
  schema: string;
  reading: "psf_corrected" | "edge";
  readings: { psf_corrected: Reading | null; edge: Reading; gaussian_profile: Reading | null };
  phases: { end_diastole: number; end_systole: number; end_rapid_filling: number } | null;
  heart: { center_mm: [number, number, number]; axis: [number, number, number]; radius_mm: number } | null;
  quality: { verdict: "ok" | "check" | "fail"; wall_variation: number | null; flags: NoteText[] };
  notes: NoteText[];
  gates: GateNumbers[];
  measures: MeasureNumbers | null;
  study: {
    format: string;
    modality: string;
    image_type: string;
    view: string;
    gates: number;
    cycle_ms: number | null;
    dims: number[] | null;
    spacing_mm: number[] | null;
  };
  provenance: {
    program: string;
    version: string;
    commit: string;
    command: string;
    inputs: { file: string; bytes: number; sha256: string }[];
    seed: number | null;
    options: unknown;
  };
  timings_s: Record<string, number> | null;
};

type Circle = [number, number, number];
/** Marks of one gate; slices count from 0, -1 is none. */
export interface GateMarks {
  circle: Circle | null;
  big_slice: number;
  division_slice: number;
  base_slice: number;
  local: (Circle | null)[];
}
export interface Grid {
  dims: [number, number, number];
  spacing_mm: [number, number, number];
  origin_mm: [number, number, number];
  direction: number[]; // row by row; columns are the world directions (LPS) of i, j, k
}
interface PackedPictures {
  grid: Grid;
  bin: number;
  columns: number;
  rows: number;
  gates: number;
  pixels: string;
  marked_gates: number;
  marks: string;
  labels: GateMarks[];
}
/** What the fit compared, in parts of healthy muscle; a byte per pixel of `grid`, gate after gate. */
interface PackedFit {
  grid: Grid;
  /** Bytes of the model reach from `low` to `high`, those of the data less the model from -`most` to `most`, 128: none. */
  low: number;
  high: number;
  most: number;
  /** Root mean square of the difference over all pixels with a weight. */
  rms: number;
  model: string;
  difference: string;
  weight: string;
}
export interface Fit extends Omit<PackedFit, "model" | "difference" | "weight"> {
  model: Uint8Array;
  difference: Uint8Array;
  /** The same for all gates, 0: not looked at. */
  weight: Uint8Array;
}
interface PackedAround {
  first: [number, number, number];
  dims: [number, number, number];
  border: string;
  longest: number;
  directions: string;
  lengths: string;
  drag: { most_kg_s: number; values: string } | null;
}
/** The voxels around a border, i fastest; the first of them in voxels of the study. */
export interface Around {
  first: [number, number, number];
  dims: [number, number, number];
  /** 1: of the border. */
  border: Uint8Array;
  /** The field that pulls the particles, 1/mm: three numbers a voxel, along i, j and k. */
  vectors: Float32Array;
  /** Drag in parts of the largest, 255: all of it; null: the same everywhere. */
  drag: { most_kg_s: number; values: Uint8Array } | null;
}
/** The way of one surface to its border, as far as its steps were kept. */
interface PackedWay {
  triangles: string;
  steps: number[];
  places: string;
  pulls: string;
  distances: string;
  strongest_n: number;
  around: PackedAround | null;
}
export interface Way extends Omit<PackedWay, "triangles" | "places" | "pulls" | "distances" | "around"> {
  particles: number;
  triangles: Uint32Array;
  /** World (LPS, mm), three numbers a particle, step after step. */
  places: Float32Array;
  /** Forces, 128: none, 1 and 255: the strongest; 0: the particle has stopped. */
  pulls: Uint8Array;
  /** From the nearest centre of a border voxel, in 1/32 of a voxel, 128: none, less: inside. */
  distances: Uint8Array;
  around: Around | null;
}
interface PackedMotion {
  gate: number;
  low_mm: number[];
  high_mm: number[];
  endo: PackedWay | null;
  epi: PackedWay | null;
}
export interface Motion {
  gate: number;
  endo: Way | null;
  epi: Way | null;
}
/** A contour in its slice, px, and the forces on its points: x and y of each. */
export interface SliceContour {
  points: number[];
  pulls: number[];
  bends: number[];
}
/** Contours of a gate, slice by slice; slices count from 0, -1 is none. */
export interface Contours {
  gate: number;
  endo: { best_slice: number; slices: (SliceContour | null)[] } | null;
  epi: { best_slice: number; slices: (SliceContour | null)[] } | null;
}
type PackedSurface = { triangles: number; positions: string } | null;
interface PackedSurfaces {
  endo: PackedSurface[];
  epi: PackedSurface[];
  low_mm: number[];
  high_mm: number[];
  triangles: string[];
}

export const mark = { endo: 1, epi: 2, minor_edge: 4, major_edge: 8 } as const;

/** All images and marks: a byte per voxel, gate after gate, i fastest. */
export interface Pictures extends Omit<PackedPictures, "pixels" | "marks"> {
  pixels: Uint8Array;
  marks: Uint8Array;
}
/** A surface of one gate: vertices in the world (LPS, mm) and in voxels, three numbers each. */
export interface Mesh {
  world: Float32Array;
  voxel: Float32Array;
  topology: number;
}
export interface Surfaces {
  triangles: Uint32Array[];
  endo: (Mesh | null)[];
  epi: (Mesh | null)[];
}
/** One polar map: samples ring by ring from the apex, counter-clockwise from the lateral wall. */
export interface PolarMap {
  name: string;
  title: string;
  unit: string;
  low: number | null;
  high: number | null;
  cyclic: boolean;
  values: (number | null)[];
}
export interface SegmentPlace {
  rho_low: number;
  rho_high: number;
  middle_deg: number;
  width_deg: number;
}
interface PackedPolar {
  rings: number;
  sectors: number;
  maps: PolarMap[];
  places: SegmentPlace[];
  endo: (string | null)[];
  epi: (string | null)[];
  samples: (string | null)[];
}
/** The segment of every vertex of a gate, 0: none. */
type VertexSegments = (Uint8Array | null)[];
export interface Polar extends Omit<PackedPolar, "endo" | "epi" | "samples"> {
  endo: VertexSegments;
  epi: VertexSegments;
  /** The sample of the maps at every vertex of the endocardium, two bytes each; 65535: none. */
  samples: (Uint8Array | null)[];
}
export interface Report {
  results: Results;
  polar: Polar | null;
  pictures: Pictures | null;
  fit: Fit | null;
  surfaces: Surfaces | null;
  motion: Motion | null;
  contours: Contours | null;
}

export function bytesOf(text: string): Uint8Array<ArrayBuffer> {
  const binary = atob(text);
  const bytes = new Uint8Array(binary.length);
  for (let n = 0; n < binary.length; ++n) bytes[n] = binary.charCodeAt(n);
  return bytes;
}

export async function unpack(text: string): Promise<Uint8Array<ArrayBuffer>> {
  const stream = new Blob([bytesOf(text)]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** World to voxels: the inverse of origin + direction * (spacing * voxel). */
export function toVoxels(grid: Grid, world: Float32Array): Float32Array {
  const voxel = new Float32Array(world.length);
  for (let n = 0; n < world.length; n += 3)
    for (let axis = 0; axis < 3; ++axis) {
      let along = 0;
      for (let row = 0; row < 3; ++row)
        along += grid.direction[3 * row + axis]! * (world[n + row]! - grid.origin_mm[row]!);
      voxel[n + axis] = along / grid.spacing_mm[axis]!;
    }
  return voxel;
}

/** Places that were written as 16-bit steps of a box. */
function placesOf(bytes: Uint8Array<ArrayBuffer>, box: { low_mm: number[]; high_mm: number[] }): Float32Array {
  const steps = new Uint16Array(bytes.buffer);
  const world = new Float32Array(steps.length);
  for (let n = 0; n < steps.length; ++n) {
    const low = box.low_mm[n % 3]!;
    world[n] = low + ((box.high_mm[n % 3]! - low) * steps[n]!) / 65535;
  }
  return world;
}

async function aroundOf(packed: PackedAround | null): Promise<Around | null> {
  if (!packed) return null;
  const directions = await unpack(packed.directions);
  const lengths = new Uint16Array((await unpack(packed.lengths)).buffer);
  const vectors = new Float32Array(3 * lengths.length);
  for (let n = 0; n < vectors.length; ++n)
    vectors[n] = ((directions[n]! - 127) / 127) * (lengths[Math.floor(n / 3)]! / 65535) * packed.longest;
  const { first, dims, drag } = packed;
  return { first, dims, vectors, border: await unpack(packed.border), drag: drag && { ...drag, values: await unpack(drag.values) } };
}

/** Borders of one gate as they would be found with what is said, and the fields around them. */
export interface Preview {
  gate: number;
  /** What the program warns of there. */
  warnings: string[];
  marks: Uint8Array;
  endo: Around | null;
  epi: Around | null;
}

/** Reads what `dynasurf borders --json` prints; null: of another stack than that of the pictures. */
export async function readPreview(text: string, pictures: Pictures): Promise<Preview | null> {
  const packed = JSON.parse(text) as { gate: number; grid: Grid; bin: number; marks: string; endo: PackedAround | null; epi: PackedAround | null; notes: NoteText[] };
  if (packed.bin !== pictures.bin || JSON.stringify(packed.grid) !== JSON.stringify(pictures.grid)) return null;
  const warnings = packed.notes.filter(({ severity, gate }) => severity !== "info" && (gate ?? packed.gate) === packed.gate).map(({ message }) => message);
  return { gate: packed.gate - 1, warnings, marks: await unpack(packed.marks), endo: await aroundOf(packed.endo), epi: await aroundOf(packed.epi) };
}

async function wayOf(packed: PackedWay | null, motion: PackedMotion): Promise<Way | null> {
  if (!packed) return null;
  const places = placesOf(await unpack(packed.places), motion);
  return {
    ...packed,
    particles: places.length / (3 * packed.steps.length),
    triangles: new Uint32Array((await unpack(packed.triangles)).buffer),
    places,
    pulls: await unpack(packed.pulls),
    distances: await unpack(packed.distances),
    around: await aroundOf(packed.around),
  };
}

function meshOf(packed: PackedSurface, surfaces: PackedSurfaces, grid: Grid | undefined): Mesh | null {
  if (!packed) return null;
  const world = placesOf(bytesOf(packed.positions), surfaces);
  return { world, voxel: grid ? toVoxels(grid, world) : world, topology: packed.triangles };
}

export async function readReport(text: string): Promise<Report> {
  const data = JSON.parse(text) as {
    results: Results;
    pictures: PackedPictures | null;
    fit: PackedFit | null;
    surfaces: PackedSurfaces | null;
    polar: PackedPolar | null;
    motion: PackedMotion | null;
    contours: Contours | null;
  };
  const segments = (gates: (string | null)[]) => gates.map((text) => (text === null ? null : bytesOf(text)));
  const packed = data.surfaces;
  const grid = data.pictures?.grid;
  return {
    results: data.results,
    polar: data.polar && { ...data.polar, endo: segments(data.polar.endo), epi: segments(data.polar.epi), samples: segments(data.polar.samples) },
    pictures: data.pictures && {
      ...data.pictures,
      pixels: await unpack(data.pictures.pixels),
      marks: await unpack(data.pictures.marks),
    },
    fit: data.fit && {
      ...data.fit,
      model: await unpack(data.fit.model),
      difference: await unpack(data.fit.difference),
      weight: await unpack(data.fit.weight),
    },
    motion: data.motion && {
      gate: data.motion.gate,
      endo: await wayOf(data.motion.endo, data.motion),
      epi: await wayOf(data.motion.epi, data.motion),
    },
    contours: data.contours,
    surfaces: packed && {
      triangles: await Promise.all(packed.triangles.map(async (t) => new Uint32Array((await unpack(t)).buffer))),
      endo: packed.endo.map((surface) => meshOf(surface, packed, grid)),
      epi: packed.epi.map((surface) => meshOf(surface, packed, grid)),
    },
  };
}

/** Whether the surfaces shown were fitted through the point spread, and have intervals. */
export const isCorrected = ({ reading }: Results): boolean => reading === "psf_corrected";
