// Which level is drawn: the same rules as dynasurf/cloud/lod.hpp.

/** Largest size on the screen, of the box's diagonal in pixels, at which each level serves; falling. */
export function limitsOf(mean_edges: number[], diagonal: number, edge_px: number): number[] {
  const limits = [Infinity];
  for (const edge of mean_edges.slice(1)) limits.push(Math.min(limits.at(-1)!, (edge_px * diagonal) / edge));
  return limits;
}

/** The coarsest level that serves; with a current one the change waits for the hysteresis. */
export function levelFor(limits: number[], size: number, current: number | null, hysteresis_percent: number): number {
  const give = hysteresis_percent / 100;
  let level = 0;
  for (let n = 1; n < limits.length; ++n) {
    const limit = current === null ? limits[n]! : limits[n]! * (n > current ? 1 - give : 1 + give);
    if (size <= limit) level = n;
  }
  return level;
}

export interface Blend {
  level: number;
  t: number;
}
/** Level `level` grown by `t` out of the next one. */
export function blendFor(limits: number[], size: number, hysteresis_percent: number): Blend {
  const band = hysteresis_percent / 100;
  let end = Infinity;
  for (let next = 1; next < limits.length; ++next) {
    const full = Math.min(limits[next]!, end);
    end = full * (1 - band);
    if (size >= full) return { level: next - 1, t: 1 };
    if (size > end) return { level: next - 1, t: (size - end) / (full - end) };
  }
  return { level: limits.length - 1, t: 1 };
}
