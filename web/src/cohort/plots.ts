// Distribution, scatter and agreement of the studies that are shown.
import { figure, html, svg } from "../dom";

export const inks = ["#0a5ea8", "#d55e00", "#1c7c3c", "#8a3ffc", "#a86400", "#5b6b7b"];

/** A dot of a plot: where it is, which study, which group. */
export interface Dot {
  x: number;
  y: number;
  study: number;
  ink: number;
}

/** Round numbers that cut a range in about `wanted` steps. */
export function ticks(low: number, high: number, wanted: number): number[] {
  const rough = Math.max(high - low, 1e-9) / wanted;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((s) => s >= rough) ?? 10 * power;
  const found: number[] = [];
  for (let n = Math.ceil(low / step - 1e-9); n * step <= high + step * 1e-9; ++n) found.push(n * step);
  return found;
}

const place = { left: 46, right: 508, top: 10 };

interface Frame {
  x(value: number): number;
  y(value: number): number;
}

/** Axes with their ticks and names; empties the picture. */
function frameOf(picture: SVGSVGElement, height: number, x: [number, number], y: [number, number], names: [string, string]): Frame {
  picture.replaceChildren();
  const bottom = height - 34;
  const to = {
    x: (v: number) => place.left + ((place.right - place.left) * (v - x[0])) / Math.max(x[1] - x[0], 1e-9),
    y: (v: number) => bottom - ((bottom - place.top) * (v - y[0])) / Math.max(y[1] - y[0], 1e-9),
  };
  const digits = (values: number[]) => (values.some((v) => Math.abs(v - Math.round(v)) > 1e-6) ? 2 : 0);
  const across = ticks(x[0], x[1], 8);
  const up = ticks(y[0], y[1], 5);
  for (const v of up) {
    picture.append(svg("path", { class: "axis", d: `M${place.left} ${to.y(v).toFixed(1)}H${place.right}` }));
    picture.append(svg("text", { x: place.left - 5, y: to.y(v) + 4, "text-anchor": "end" }, v.toFixed(digits(up))));
  }
  for (const v of across) picture.append(svg("text", { x: to.x(v), y: bottom + 14, "text-anchor": "middle" }, v.toFixed(digits(across))));
  picture.append(svg("path", { class: "axis", d: `M${place.left} ${bottom}H${place.right}` }));
  picture.append(svg("text", { x: (place.left + place.right) / 2, y: height - 4, "text-anchor": "middle" }, names[0]));
  picture.append(svg("text", { x: 11, y: (place.top + bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 11 ${(place.top + bottom) / 2})` }, names[1]));
  return to;
}

function rangeOf(values: number[], margin: number): [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const v of values) {
    low = Math.min(low, v);
    high = Math.max(high, v);
  }
  if (!(low <= high)) return [0, 1];
  if (high - low < 1e-6) return [low - 1, high + 1]; // all the same
  const wide = (high - low) * margin;
  return [low - wide, high + wide];
}

/** The normal range of a number: the middle 95 % of the values of normal studies; none of fewer than 20, too few for its ends. */
export function normalRange(values: number[]): [number, number] | undefined {
  if (values.length < 20) return undefined;
  const sorted = [...values].sort((a, b) => a - b);
  const at = (share: number) => {
    const place = share * (sorted.length - 1);
    const low = Math.floor(place);
    return sorted[low]! + (place - low) * (sorted[Math.min(low + 1, sorted.length - 1)]! - sorted[low]!);
  };
  return [at(0.025), at(0.975)];
}

/** Columns of a distribution, a colour a group, on top of each other, before the normal range. */
export function drawHistogram(picture: SVGSVGElement, groups: Map<string, number[]>, name: string, normal: [number, number] | undefined): void {
  const all = [...groups.values()].flat();
  const [low, high] = rangeOf(all, 0.02);
  const count = Math.max(8, Math.min(40, Math.round(2 * Math.cbrt(all.length)) * 2));
  const bins = [...groups.values()].map((values) => {
    const bin = new Array<number>(count).fill(0);
    for (const v of values) bin[Math.min(count - 1, Math.floor(((v - low) / (high - low)) * count))]! += 1;
    return bin;
  });
  const sums = Array.from({ length: count }, (_, n) => bins.reduce((sum, bin) => sum + bin[n]!, 0));
  const to = frameOf(picture, 210, [low, high], [0, Math.max(1, ...sums) * 1.08], [name, "studies"]);
  if (normal) {
    const [from, end] = normal.map((v) => Math.min(Math.max(to.x(v), place.left), place.right)) as [number, number];
    picture.append(svg("rect", { class: "normal", x: from, width: end - from, y: place.top, height: 210 - 34 - place.top }));
  }
  for (let n = 0; n < count; ++n) {
    let from = 0;
    bins.forEach((bin, g) => {
      const x = to.x(low + ((high - low) * n) / count);
      const width = to.x(low + ((high - low) * (n + 1)) / count) - x;
      if (bin[n]! > 0)
        picture.append(svg("rect", { x: x + 0.5, width: Math.max(width - 1, 0.5), y: to.y(from + bin[n]!), height: to.y(from) - to.y(from + bin[n]!), fill: inks[g % inks.length]!, "fill-opacity": 0.8 }));
      from += bin[n]!;
    });
  }
}

/** All dots of one colour are one path: ten thousand elements would be slow. */
function drawDots(picture: SVGSVGElement, dots: Dot[], to: Frame): void {
  const paths = new Map<number, string>();
  for (const dot of dots) {
    const step = `M${to.x(dot.x).toFixed(1)} ${to.y(dot.y).toFixed(1)}h0`;
    paths.set(dot.ink, (paths.get(dot.ink) ?? "") + step);
  }
  for (const [ink, d] of paths)
    picture.append(svg("path", { d, stroke: inks[ink % inks.length]!, "stroke-width": dots.length > 2000 ? 3 : 5, "stroke-linecap": "round", "stroke-opacity": dots.length > 2000 ? 0.35 : 0.6, fill: "none" }));
}

/** Puts a ring around the dot of a study; the other dots stay as they are. */
export type Ring = (study: number) => void;

function ringOf(picture: SVGSVGElement, dots: Dot[], to: Frame): Ring {
  const at = new Map(dots.map((dot) => [dot.study, dot]));
  const circle = svg("circle", { r: 7, fill: "none", stroke: "#111", "stroke-width": 2, visibility: "hidden" });
  picture.append(circle);
  return (study) => {
    const dot = at.get(study);
    circle.setAttribute("visibility", dot ? "visible" : "hidden");
    if (!dot) return;
    circle.setAttribute("cx", String(to.x(dot.x)));
    circle.setAttribute("cy", String(to.y(dot.y)));
  };
}

/** A click chooses the nearest study. */
function listen(picture: SVGSVGElement, dots: Dot[], to: Frame, choose: (study: number) => void): void {
  picture.onclick = (event) => {
    const box = picture.getBoundingClientRect();
    const scale = picture.viewBox.baseVal.width / box.width;
    const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    let best: Dot | undefined;
    let least = 144;
    for (const dot of dots) {
      const distance = (to.x(dot.x) - x) ** 2 + (to.y(dot.y) - y) ** 2;
      if (distance < least) [best, least] = [dot, distance];
    }
    if (best) choose(best.study);
  };
}

export function drawScatter(picture: SVGSVGElement, dots: Dot[], names: [string, string], choose: (study: number) => void): Ring {
  const to = frameOf(picture, 260, rangeOf(dots.map((d) => d.x), 0.04), rangeOf(dots.map((d) => d.y), 0.06), names);
  drawDots(picture, dots, to);
  listen(picture, dots, to, choose);
  return ringOf(picture, dots, to);
}

/** Differences over means (Bland and Altman) with bias and limits of agreement, which it returns in words too. */
export function drawAgreement(picture: SVGSVGElement, dots: Dot[], unit: string, choose: (study: number) => void): [Ring, string] {
  if (dots.length < 2) {
    frameOf(picture, 260, [0, 1], [0, 1], ["", ""]);
    return [() => undefined, "Fewer than two studies have both numbers."];
  }
  const mean = dots.reduce((sum, d) => sum + d.y, 0) / dots.length;
  const sd = Math.sqrt(dots.reduce((sum, d) => sum + (d.y - mean) ** 2, 0) / (dots.length - 1));
  const lines = [mean - 1.96 * sd, mean, mean + 1.96 * sd];
  const to = frameOf(picture, 260, rangeOf(dots.map((d) => d.x), 0.04), rangeOf([...dots.map((d) => d.y), ...lines], 0.06), [`mean of both, ${unit}`, `difference, ${unit}`]);
  drawDots(picture, dots, to);
  lines.forEach((v, n) => {
    picture.append(svg("path", { d: `M${place.left} ${to.y(v).toFixed(1)}H${place.right}`, stroke: "#111", "stroke-dasharray": n === 1 ? "none" : "6 4" }));
    picture.append(svg("text", { x: place.right - 2, y: to.y(v) - 4, "text-anchor": "end" }, figure(v, 1)));
  });
  listen(picture, dots, to, choose);
  const words = `Bias ${figure(mean, 2)} ${unit}, limits of agreement ${figure(lines[0], 2)} to ${figure(lines[2], 2)} ${unit}, n = ${dots.length} of the studies shown.`;
  return [ringOf(picture, dots, to), words];
}

/** Mean, deviation, median and n of each group. */
export function meansTable(groups: Map<string, number[]>): HTMLElement[] {
  const rows = [html("tr", {}, html("th", {}, ""), ...["n", "mean", "SD", "median", "5 to 95 %"].map((t) => html("th", { class: "number" }, t)))];
  [...groups].forEach(([name, values], n) => {
    const sorted = [...values].sort((a, b) => a - b);
    const at = (share: number) => sorted[Math.min(sorted.length - 1, Math.round(share * (sorted.length - 1)))];
    const mean = values.reduce((sum, v) => sum + v, 0) / values.length;
    const sd = values.length > 1 ? Math.sqrt(values.reduce((sum, v) => sum + (v - mean) ** 2, 0) / (values.length - 1)) : null;
    const cells = [String(values.length), figure(mean), figure(sd), figure(at(0.5)), `${figure(at(0.05))} to ${figure(at(0.95))}`];
    const first = html("td", {}, name);
    first.style.color = inks[n % inks.length]!;
    rows.push(html("tr", {}, first, ...cells.map((t) => html("td", { class: "number" }, t))));
  });
  return rows;
}
