// How the meshes came to rest on their borders: played, stepped or scrubbed, with the forces that move the particles.
import {
  BufferAttribute,
  BufferGeometry,
  Color,
  DoubleSide,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshPhongMaterial,
  Points,
  PointsMaterial,
  Vector3,
  type Object3D,
} from "three";

import { borderCubes, dragCubes, fieldLines } from "./around";
import { walls, type Grid, type Motion, type WallName, type Way } from "./data";
import { colour, figure, html } from "./dom";
import { ParticleCharts } from "./particles";
import { Stage3d } from "./stage3d";
import { say, wall_words } from "./words";

const moving_colour = new Color("#f2f4f8");
const play_ms = 5000;
/** How near to a particle the pointer must be, in pixels. */
const reach_px = 14;

/** The last kept step of a surface at or before a step. */
export function keptAt(way: Way, step: number): number {
  let kept = 0;
  while (kept + 1 < way.steps.length && way.steps[kept + 1]! <= step) ++kept;
  return kept;
}

/** Whether a particle had reached its border by a kept step. */
export function isStopped(way: Way, kept: number, particle: number): boolean {
  return way.pulls[3 * (kept * way.particles + particle)] === 0;
}

/** Newtons on a particle that moves. */
function forceOn(way: Way, kept: number, particle: number): Vector3 {
  const at = 3 * (kept * way.particles + particle);
  const part = (axis: number) => ((way.pulls[at + axis]! - 128) / 127) * way.strongest_n;
  return new Vector3(part(0), part(1), part(2));
}

interface Shown {
  name: WallName;
  way: Way;
  surface: BufferGeometry;
  forces: BufferGeometry;
}

export class MotionView {
  private readonly stage: Stage3d;
  private readonly shown: Shown[] = [];
  private readonly force_lines: LineSegments[] = [];
  private readonly longest_n: number;
  private readonly last: number;
  private readonly charts_place = html("div", { class: "particle-charts" });
  private charted: { name: WallName; way: Way; charts: ParticleCharts } | null = null;
  private step = 0;
  private readonly listeners: ((step: number) => void)[] = [];

  private readonly slider: HTMLInputElement;
  private readonly play = html("button", { class: "primary", "aria-pressed": "false" }, say("Play"));
  private readonly now = html("output", {});
  private readonly pointed = html("p", { class: "caption", "aria-live": "polite" }, say("Point at a particle to see the force on it. Drag to turn."));

  /** Throws when the browser has no WebGL. */
  constructor(place: HTMLElement, motion: Motion, private readonly grid: Grid) {
    const ways = walls.flatMap((name) => (motion[name] ? [{ name, way: motion[name] }] : []));
    const ends = ways.flatMap(({ way }) => [...way.places.subarray(0, 3 * way.particles), ...way.places.subarray(-3 * way.particles)]);
    this.stage = new Stage3d(grid, ends, say("The meshes on their way to the borders. Drag to turn."));
    this.last = Math.max(...ways.map(({ way }) => way.steps.at(-1)!));
    this.slider = html("input", { type: "range", min: 0, max: this.last, value: 0, "aria-label": say("Step of the motion") });
    this.longest_n = Math.max(...ways.map(({ way }) => way.strongest_n)) || 1;
    for (const { name, way } of ways) this.add(name, way);
    place.replaceChildren(this.bar(), html("div", { class: "motion-body" }, html("div", {}, this.stage.frame, this.pointed), this.charts_place));
    this.chart(this.shown[0]!);
    this.stage.canvas.addEventListener("pointermove", (event) => event.buttons || this.point(event));
    this.seek(0);
  }

  /** Tells each step that is shown, the present one at once. */
  listen(listener: (step: number) => void): void {
    this.listeners.push(listener);
    listener(this.step);
  }

  private bar(): HTMLElement {
    const button = (text: string, label: string, action: () => void) => {
      const made = html("button", { "aria-label": label, title: label }, text);
      made.addEventListener("click", action);
      return made;
    };
    this.play.addEventListener("click", () => this.toggle());
    this.slider.addEventListener("input", () => {
      this.stop();
      this.seek(this.slider.valueAsNumber);
    });
    const chosen = html("select", { "aria-label": say("Wall of the charts") }, ...this.shown.map(({ name }) => html("option", {}, wall_words[name])));
    chosen.addEventListener("change", () => this.chart(this.shown[chosen.selectedIndex]!));
    return html(
      "div",
      { class: "motion-bar" },
      button("◀", say("Kept step before"), () => this.jump(-1)),
      this.play,
      button("▶", say("Next kept step"), () => this.jump(1)),
      this.slider,
      this.now,
      this.toggle3d(say("Forces"), true, () => this.force_lines),
      ...this.surroundings(),
      ...(this.shown.length > 1 ? [html("label", { class: "select" }, `${say("Charts of")} `, chosen)] : []),
    );
  }

  /** A checkbox that shows parts of the scene; what is not there is made when it is first asked for. */
  private toggle3d(name: string, checked: boolean, make: () => Object3D[]): HTMLElement {
    const box = html("input", { type: "checkbox", checked });
    let parts = checked ? make() : null;
    box.addEventListener("change", () => {
      parts ??= make();
      for (const part of parts) part.visible = box.checked;
      this.stage.render();
    });
    return html("label", { class: "select" }, box, ` ${name}`);
  }

  /** What the particles moved in. */
  private surroundings(): HTMLElement[] {
    const known = this.shown.flatMap(({ name, way }) => (way.around ? [{ name, around: way.around }] : []));
    if (known.length === 0) return [];
    const added = (parts: (Object3D | null)[]) => {
      const made = parts.filter((part) => part !== null);
      this.stage.heart.add(...made);
      return made;
    };
    return [
      this.toggle3d(say("Border voxels"), false, () => added(known.map(({ name, around }) => borderCubes(around, this.grid, colour[name], name === "endo" ? 0.9 : 0.2)))),
      this.toggle3d(say("Field lines"), false, () => added(known.map(({ around }) => fieldLines(around, this.grid)))),
      ...(known.some(({ around }) => around.drag) ? [this.toggle3d(say("Drag"), false, () => added(known.map(({ around }) => dragCubes(around, this.grid))))] : []),
    ];
  }

  private add(name: WallName, way: Way): void {
    const surface = new BufferGeometry();
    surface.setAttribute("position", new BufferAttribute(new Float32Array(3 * way.particles), 3));
    surface.setAttribute("color", new BufferAttribute(new Float32Array(3 * way.particles), 3));
    surface.setIndex(new BufferAttribute(way.triangles, 1));
    const forces = new BufferGeometry();
    forces.setAttribute("position", new BufferAttribute(new Float32Array(6 * way.particles), 3));
    const inner = name === "endo";
    const skin = new Mesh(surface, new MeshPhongMaterial({ color: colour[name], side: DoubleSide, transparent: true, opacity: inner ? 0.5 : 0.12, depthWrite: false }));
    const wires = new Mesh(surface, new MeshPhongMaterial({ color: colour[name], wireframe: true, transparent: true, opacity: inner ? 0.35 : 0.2, depthWrite: false }));
    const particles = new Points(surface, new PointsMaterial({ size: 4, sizeAttenuation: false, vertexColors: true }));
    const lines = new LineSegments(forces, new LineBasicMaterial({ color: colour.lit, transparent: true, opacity: 0.8 }));
    for (const part of [skin, wires, particles, lines]) {
      part.frustumCulled = false;
      this.stage.heart.add(part);
    }
    this.force_lines.push(lines);
    this.shown.push({ name, way, surface, forces });
  }

  private chart({ name, way }: Shown): void {
    this.charted = { name, way, charts: new ParticleCharts(this.charts_place, way, wall_words[name]) };
    this.charted.charts.show(this.step, keptAt(way, this.step));
  }

  private toggle(): void {
    if (this.play.getAttribute("aria-pressed") === "true") return this.stop();
    if (this.step >= this.last) this.seek(0);
    this.play.setAttribute("aria-pressed", "true");
    this.play.textContent = say("Pause");
    let [exact, before] = [this.step, performance.now()];
    const tick = (now: number) => {
      if (this.play.getAttribute("aria-pressed") !== "true") return;
      exact += (Math.min(now - before, 500) / play_ms) * this.last;
      before = now;
      this.seek(Math.min(this.last, Math.floor(exact)));
      if (this.step >= this.last) this.stop();
      else requestAnimationFrame(tick);
    };
    requestAnimationFrame(tick);
  }

  private stop(): void {
    this.play.setAttribute("aria-pressed", "false");
    this.play.textContent = say("Play");
  }

  /** To the next step, or the one before, of which the places were kept. */
  private jump(by: 1 | -1): void {
    this.stop();
    const steps = [...new Set(this.shown.flatMap(({ way }) => way.steps))].sort((a, b) => a - b);
    const next = by > 0 ? steps.find((s) => s > this.step) : steps.filter((s) => s < this.step).at(-1);
    if (next !== undefined) this.seek(next);
  }

  seek(step: number): void {
    this.step = step;
    this.slider.value = String(step);
    const words: string[] = [];
    for (const { name, way, surface, forces } of this.shown) {
      const kept = keptAt(way, step);
      const position = surface.getAttribute("position") as BufferAttribute;
      const paint = surface.getAttribute("color") as BufferAttribute;
      const arrows = forces.getAttribute("position") as BufferAttribute;
      const places = way.places.subarray(3 * kept * way.particles, 3 * (kept + 1) * way.particles);
      (position.array as Float32Array).set(places);
      const resting = new Color(colour[name]);
      let stopped = 0;
      for (let v = 0; v < way.particles; ++v) {
        const rests = isStopped(way, kept, v);
        stopped += rests ? 1 : 0;
        const { r, g, b } = rests ? resting : moving_colour;
        paint.setXYZ(v, r, g, b);
        const force = rests ? new Vector3() : forceOn(way, kept, v).multiplyScalar((0.16 * this.stage.radius) / this.longest_n);
        arrows.setXYZ(2 * v, places[3 * v]!, places[3 * v + 1]!, places[3 * v + 2]!);
        arrows.setXYZ(2 * v + 1, places[3 * v]! + force.x, places[3 * v + 1]! + force.y, places[3 * v + 2]! + force.z);
      }
      for (const attribute of [position, paint, arrows]) attribute.needsUpdate = true;
      surface.computeVertexNormals();
      words.push(say("{wall} {n} of {all} stopped", { wall: wall_words[name], n: stopped, all: way.particles }));
    }
    if (this.charted) this.charted.charts.show(step, keptAt(this.charted.way, step));
    for (const listener of this.listeners) listener(step);
    this.now.textContent = `${say("Step {n} of {all}", { n: step, all: this.last })} · ${words.join(", ")}`;
    this.stage.render();
  }

  /** Tells of the particle under the pointer. */
  private point(event: PointerEvent): void {
    const box = this.stage.canvas.getBoundingClientRect();
    let best = { distance: reach_px, depth: Infinity, text: "" };
    for (const { name, way } of this.shown) {
      const kept = keptAt(way, this.step);
      for (let v = 0; v < way.particles; ++v) {
        const at = (step: number) => new Vector3().fromArray(way.places, 3 * (step * way.particles + v));
        const seen = this.stage.heart.localToWorld(at(kept)).project(this.stage.camera);
        const distance = Math.hypot(((seen.x + 1) / 2) * box.width - (event.clientX - box.left), ((1 - seen.y) / 2) * box.height - (event.clientY - box.top));
        if (distance > reach_px || (Math.abs(distance - best.distance) < 4 ? seen.z >= best.depth : distance >= best.distance)) continue;
        const state = isStopped(way, kept, v) ? say("stopped at its border") : say("force {n} N", { n: forceOn(way, kept, v).length().toPrecision(3) });
        const facts = { n: v, wall: wall_words[name], mm: figure(at(kept).distanceTo(at(0))), state };
        best = { distance, depth: seen.z, text: say("Particle {n} of {wall}: {mm} mm from its start, {state}", facts) };
      }
    }
    if (best.text) this.pointed.textContent = best.text;
  }
}
