// Polar maps of the wall and the table of its segments: what is pointed at in one is lit in all.
import type { Interval, MeasureNumbers, Polar, PolarMap, SegmentNumbers, SegmentPlace } from "./data";
import { byId, figure, html, svg } from "./dom";
import { say, told } from "./words";

const radius = 100;
const even = ["#440154", "#48287a", "#3e4a89", "#31688e", "#26828e", "#1f9e89", "#35b779", "#90d743", "#fde725"];
const circle = ["#74395a", "#9f5634", "#c7964c", "#d6db9f", "#96cdc4", "#5a98c0", "#565e99", "#74395a"];

function channels(hex: string): number[] {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}

/** A colour at `share` (0 to 1) of a scale. */
function colourAt(share: number, scale: string[]): string {
  const place = Math.min(Math.max(share, 0), 1) * (scale.length - 1);
  const low = Math.min(Math.floor(place), scale.length - 2);
  const [a, b] = [channels(scale[low]!), channels(scale[low + 1]!)];
  return `rgb(${a.map((v, n) => Math.round(v + (place - low) * (b[n]! - v))).join(",")})`;
}

/** From dark blue over green to yellow: told apart by everyone. */
export const evenColour = (share: number): string => colourAt(share, even);

function point(rho: number, deg: number): string {
  const angle = (deg * Math.PI) / 180;
  return `${(radius * rho * Math.cos(angle)).toFixed(2)} ${(-radius * rho * Math.sin(angle)).toFixed(2)}`;
}

/** The outline of a piece of a ring. */
function piece(low: number, high: number, from: number, width: number): string {
  const arc = (rho: number, to: number, back: boolean) => `A${radius * rho} ${radius * rho} 0 0 ${back ? 1 : 0} ${point(rho, to)}`;
  if (width >= 360) return `M${point(high, 0)}${arc(high, 180, false)}${arc(high, 360, false)}Z`;
  const to = from + width;
  return `M${point(low, from)}L${point(high, from)}${arc(high, to, false)}L${point(low, to)}${low > 0 ? arc(low, from, true) : ""}Z`;
}

const outline = (place: SegmentPlace) =>
  piece(place.rho_low, place.rho_high, place.middle_deg - place.width_deg / 2, place.width_deg);

function rangeOf(map: PolarMap): [number, number] {
  const values = map.values.filter((v) => v !== null);
  return [map.low ?? Math.floor(Math.min(...values, 0)), map.high ?? Math.ceil(Math.max(...values, 1))];
}

/** Keys of a segment's numbers, as the maps are called. */
type MapName = Exclude<keyof SegmentNumbers, "number" | "name" | "territory" | "wall_share_percent" | `${string}_90`>;

/** Half of the 90 % interval of a segment's number, null where there is none. */
function halfWidth(segment: SegmentNumbers, key: MapName): number | null {
  const interval = segment[`${key}_90` as keyof SegmentNumbers] as Interval | undefined;
  return interval && interval[0] !== null && interval[1] !== null ? (interval[1] - interval[0]) / 2 : null;
}
const digitsOf = (key: string) => (key.endsWith("_mm") ? 1 : 0);

const columns: [MapName, string, string][] = [
  ["perfusion_percent", say("Perfusion"), "%"],
  ["thickness_ed_mm", say("Thickness ED"), "mm"],
  ["thickness_es_mm", "ES", "mm"],
  ["thickening_percent", say("Thickening"), "%"],
  ["count_thickening_percent", say("by counts"), "%"],
  ["motion_mm", say("Motion"), "mm"],
  ["area_strain_percent", say("Area strain"), "%"],
  ["phase_counts_deg", say("Onset, counts"), "°"],
  ["phase_motion_deg", say("motion"), "°"],
];

/** The colour of a sample of a map, null where it has no value. */
export function colourOfSample(map: PolarMap, sample: number): string | null {
  const value = map.values[sample] ?? null;
  if (value === null) return null;
  const [low, high] = rangeOf(map);
  return colourAt((value - low) / (high - low || 1), map.cyclic ? circle : even);
}

/** Draws a map into `picture`; returns the outlines of its segments. */
export function drawPolar(picture: SVGSVGElement, polar: Polar, map: PolarMap, title: string): SVGElement[] {
  const { rings, sectors, places } = polar;
  const [low, high] = rangeOf(map);
  const scale = map.cyclic ? circle : even;
  const colour = (value: number) => colourAt((value - low) / (high - low || 1), scale);
  const cells = map.values.flatMap((value, n) => {
    if (value === null) return [];
    const ring = Math.floor(n / sectors);
    const d = piece(ring / rings, (ring + 1) / rings, ((n % sectors) * 360) / sectors, 360 / sectors + 0.4);
    return [svg("path", { d, fill: colour(value) })];
  });
  const outlines = places.map((place, n) => svg("path", { d: outline(place), class: "segment", "data-segment": n + 1 }));
  const words = ([[say("anterior"), 0, -107], [say("inferior"), 0, 115]] as const).map(([word, x, y]) => svg("text", { x, y }, word));
  const turned = ([[say("septal"), -108], [say("lateral"), 115]] as const).map(([word, x]) =>
    svg("text", { transform: `translate(${x} 0) rotate(-90)` }, word),
  );
  const bar = Array.from({ length: 40 }, (_, n) =>
    svg("rect", { x: 124, y: 80 - (n + 1) * 4, width: 7, height: 4.2, fill: colourAt((n + 0.5) / 40, scale) }),
  );
  const ends = ([[low, 83], [(low + high) / 2, 3], [high, -77]] as const).map(([value, y]) =>
    svg("text", { x: 134, y, class: "side" }, figure(value, 0)),
  );
  picture.setAttribute("aria-label", say("Polar map: {title}", { title }));
  picture.replaceChildren(...cells, svg("g", {}, ...outlines), ...words, ...turned, ...bar, ...ends);
  return outlines;
}

/** What a map is called; thickness between edges is apparent. */
export function titleOfMap(map: PolarMap, measures: MeasureNumbers): string {
  const apparent = measures.thickness_is === "apparent" && map.name.startsWith("thick");
  return `${told(map.title)}${apparent ? ` (${say("apparent")})` : ""}, ${told(map.unit)}`;
}

export class PolarView {
  private readonly picture = svg("svg", { viewBox: "-122 -122 276 244", role: "img", class: "polar" });
  private readonly caption = html("p", { class: "polar-caption", "aria-live": "polite" });
  private readonly rows: HTMLTableRowElement[];
  private outlines: SVGElement[] = [];
  private map: PolarMap;
  private lit = 0;
  private readonly cross = svg("path", { class: "cross", d: "M-6 0H6M0 -6V6" });

  /** `point` is told the number of the segment that is pointed at, 0: none; `go` the place that is clicked on. */
  constructor(
    private readonly polar: Polar,
    private readonly measures: MeasureNumbers,
    private readonly point: (segment: number) => void,
    private readonly go: (rho: number, deg: number) => void,
    private readonly painted: (map: PolarMap | null) => void,
  ) {
    this.map = polar.maps[0]!;
    const choice = byId<HTMLSelectElement>("polar-map");
    choice.replaceChildren(...polar.maps.map((map, n) => html("option", { value: n }, this.titleOf(map))));
    choice.addEventListener("change", () => {
      this.map = polar.maps[Number(choice.value)]!;
      this.draw();
    });
    byId<HTMLInputElement>("polar-paint").addEventListener("change", () => this.paint());
    byId("polar").replaceChildren(this.picture, this.caption);
    this.picture.addEventListener("click", (event) => {
      const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.picture.getScreenCTM()!.inverse());
      if (Math.hypot(x, y) <= radius) this.go(Math.hypot(x, y) / radius, (Math.atan2(-y, x) * 180) / Math.PI);
    });
    const table = segmentTable(measures);
    this.rows = [...table.tBodies[0]!.rows];
    this.rows.forEach((row, n) => {
      row.addEventListener("pointerenter", () => this.point(n + 1));
      row.addEventListener("pointerleave", () => this.point(0));
    });
    byId("segments").replaceChildren(table);
    this.draw();
  }

  private titleOf(map: PolarMap): string {
    return titleOfMap(map, this.measures);
  }

  /** Lights a segment, 0: none. */
  light(segment: number): void {
    if (segment === this.lit) return;
    this.lit = segment;
    this.mark();
  }

  /** Marks where the cursor is, null: away from the wall. */
  markCursor(place: { rho: number; deg: number } | null): void {
    this.cross.style.display = place ? "" : "none";
    if (place) this.cross.setAttribute("transform", `translate(${point(place.rho, place.deg)})`);
  }

  private mark(): void {
    this.rows.forEach((row, n) => row.toggleAttribute("aria-current", n + 1 === this.lit));
    this.outlines.forEach((path, n) => path.classList.toggle("lit", n + 1 === this.lit));
    // What is lit must not lie under its neighbours' borders.
    if (this.lit > 0) this.outlines[this.lit - 1]?.parentNode?.append(this.outlines[this.lit - 1]!);
    const segment = this.measures.segments[this.lit - 1];
    const value = segment?.[this.map.name as MapName];
    const half = segment ? halfWidth(segment, this.map.name as MapName) : null;
    this.caption.textContent = segment
      ? `${segment.number} ${told(segment.name)} (${told(segment.territory)}): ${figure(value)}${half === null ? "" : ` ± ${figure(half)}`} ${told(this.map.unit)}`
      : say("Seen from the apex. Point at a segment.");
  }

  private draw(): void {
    this.outlines = drawPolar(this.picture, this.polar, this.map, this.titleOf(this.map));
    this.outlines.forEach((path, n) => path.addEventListener("pointerenter", () => this.point(n + 1)));
    this.picture.onpointerleave = () => this.point(0);
    this.picture.append(this.cross);
    this.mark();
    this.paint();
  }

  /** Puts the map's colours on the heart, or takes them off. */
  private paint(): void {
    this.painted(byId<HTMLInputElement>("polar-paint").checked ? this.map : null);
  }
}

type Column = (typeof columns)[number];

function segmentRow(segment: SegmentNumbers, shown: Column[]): HTMLTableRowElement {
  const cell = (key: MapName) => {
    const half = halfWidth(segment, key);
    const bar = half === null ? [] : [html("small", {}, ` ± ${figure(half, digitsOf(key))}`)];
    return html("td", {}, figure(segment[key], digitsOf(key)), ...bar);
  };
  return html(
    "tr",
    { "data-segment": segment.number },
    html("th", { scope: "row" }, `${segment.number} ${told(segment.name)}`),
    html("td", {}, told(segment.territory)),
    ...shown.map(([key]) => cell(key)),
  );
}

/** Columns without any number are left out; a column's name is short beside the one before it. */
export function segmentTable({ segments }: MeasureNumbers): HTMLTableElement {
  const has = (key: MapName) => segments.some((segment) => segment[key] !== null);
  const shown = columns
    .filter(([key]) => has(key))
    .map(([key, name, unit]): Column => [key, key === "phase_motion_deg" && !has("phase_counts_deg") ? say("Onset, motion") : name, unit]);
  return html(
    "table",
    { class: "numbers" },
    html(
      "thead",
      {},
      html(
        "tr",
        {},
        html("th", { scope: "col" }, say("Segment")),
        html("th", { scope: "col" }, say("Artery")),
        ...shown.map(([, name, unit]) => html("th", { scope: "col" }, name, html("small", {}, unit))),
      ),
    ),
    html("tbody", {}, ...segments.map((segment) => segmentRow(segment, shown))),
  );
}
