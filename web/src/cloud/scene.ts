// The cloud and the levels beside each other, or one surface that turns into the next; one eye for all.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  Fog,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshPhongMaterial,
  Object3D,
  PerspectiveCamera,
  Points,
  PointsMaterial,
  Scene,
  Vector3,
  WebGLRenderer,
  WireframeGeometry,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import type { CloudReport, Level } from "./data";

export type Colouring = "error" | "plain" | "own";
export interface Look {
  colouring: Colouring;
  full: number; // distance at the end of the colour scale
  wire: boolean;
  flat: boolean;
  points: boolean;
  made_up: boolean; // draws what no point supports in its own colour
}

const ramp = [0x5b83e6, 0x25a3b8, 0x7fd068, 0xf2c84b, 0xd8402f].map((hex) => new Color(hex));
const least_tile_px = 150;
const made_up = new Color(0xc25be0);
const unknown = new Color(0x4a5563), plain = new Color(0xb9c6d4);

/** Colour of a distance; grey where nothing can be said. */
export function colourOf(error: number, full: number): Color {
  if (error < 0) return unknown;
  const at = Math.min(full > 0 ? error / full : 0, 1) * (ramp.length - 1);
  const below = Math.min(Math.floor(at), ramp.length - 2);
  return ramp[below]!.clone().lerp(ramp[below + 1]!, at - below);
}

/** One surface with all the ways to draw it. */
export class Surface {
  readonly group = new Object3D();
  private readonly geometry = new BufferGeometry();
  private readonly material = new MeshPhongMaterial({ vertexColors: true, shininess: 18, specular: 0x222831, side: DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 });
  private wires: LineSegments | null = null;
  private wired = "";

  constructor(private level: Level) {
    this.group.add(new Mesh(this.geometry, this.material));
    this.choose(level);
  }

  /** Shows another level. */
  choose(level: Level): void {
    this.level = level;
    this.geometry.setAttribute("position", new BufferAttribute(level.positions.slice(), 3));
    this.geometry.setAttribute("color", new BufferAttribute(new Float32Array(level.positions.length), 3));
    this.geometry.setIndex(new BufferAttribute(level.triangles, 1));
    this.geometry.computeVertexNormals();
  }

  /** Direction outwards at a vertex. */
  normalAt(vertex: number): Vector3 {
    return new Vector3().fromBufferAttribute(this.geometry.getAttribute("normal"), vertex);
  }

  /** Grown by t out of the next level. */
  morph(t: number): void {
    const { start, positions } = this.level;
    const places = this.geometry.getAttribute("position").array as Float32Array;
    for (let n = 0; n < places.length; ++n) places[n] = start && t < 1 ? start[n]! + t * (positions[n]! - start[n]!) : positions[n]!;
    this.geometry.getAttribute("position").needsUpdate = true;
    this.geometry.computeVertexNormals();
    this.wired = "";
  }

  dress(look: Look): void {
    const colours = this.geometry.getAttribute("color");
    const { errors, confidence, colours: own } = this.level;
    const colour = new Color();
    for (let v = 0; v < errors.length; ++v) {
      if (look.colouring === "error") colour.copy(colourOf(errors[v]!, look.full));
      else if (look.colouring === "own" && own) colour.setRGB(own[3 * v]! / 255, own[3 * v + 1]! / 255, own[3 * v + 2]! / 255, "srgb");
      else colour.copy(plain);
      if (look.made_up && confidence[v]! < 1) colour.lerp(made_up, Math.min(1, 0.4 + 2 * (1 - confidence[v]!)));
      colours.setXYZ(v, colour.r, colour.g, colour.b);
    }
    colours.needsUpdate = true;
    this.material.flatShading = look.flat;
    this.material.needsUpdate = true;
    this.drawWires(look.wire);
  }

  private drawWires(on: boolean): void {
    const key = `${on} ${this.level.numbers.level}`;
    if (this.wired === key) return;
    this.wired = key;
    if (this.wires) {
      this.group.remove(this.wires);
      this.wires.geometry.dispose();
      this.wires = null;
    }
    if (!on) return;
    this.wires = new LineSegments(new WireframeGeometry(this.geometry), new LineBasicMaterial({ color: 0x0a0f15, transparent: true, opacity: 0.55 }));
    this.group.add(this.wires);
  }
}

export function pointsOf(report: CloudReport, size: number): Points {
  const geometry = new BufferGeometry();
  const { positions, colours } = report.points;
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  if (colours) geometry.setAttribute("color", new BufferAttribute(linear(colours), 3));
  return new Points(geometry, new PointsMaterial({ size, sizeAttenuation: false, vertexColors: colours !== null, color: colours ? 0xffffff : 0x9fd0ff }));
}

function linear(bytes: Uint8Array): Float32Array {
  const colour = new Color();
  const out = new Float32Array(bytes.length);
  for (let n = 0; n < bytes.length; n += 3) colour.setRGB(bytes[n]! / 255, bytes[n + 1]! / 255, bytes[n + 2]! / 255, "srgb").toArray(out, n);
  return out;
}

/** A canvas cut into tiles, each with its own scene, and room for a label at its top. */
export class Tiles {
  readonly camera = new PerspectiveCamera(30, 1, 0.01, 100);
  readonly controls: OrbitControls;
  private readonly renderer: WebGLRenderer;
  private readonly scenes: Scene[] = [];
  private readonly roots: Object3D[] = [];
  /** Points have no light and shade: what is far away fades instead. */
  private readonly fog = new Fog(0x16202c);
  private waiting = false;

  /** Throws when the browser has no WebGL. */
  constructor(private readonly place: HTMLElement, name: string, private readonly radius: number, private readonly label_px = 0) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", name);
    place.prepend(canvas);
    this.camera.near = radius / 100;
    this.camera.far = radius * 100;
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.render());
    this.reset();
    new ResizeObserver(() => this.resize()).observe(place);
    addEventListener("beforeprint", () => this.draw());
  }

  add(...objects: Object3D[]): void {
    const scene = new Scene();
    if (objects.every((object) => object instanceof Points)) scene.fog = this.fog;
    const root = new Object3D().add(...objects);
    this.roots.push(root);
    scene.add(new AmbientLight(0xffffff, 0.8), root);
    for (const [x, y, z, strength] of [[-1, 1.4, 1.2, 2], [1.6, -0.6, 0.6, 0.7], [0.4, 0.3, -1.4, 0.5]] as const) {
      const light = new DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      scene.add(light);
    }
    this.scenes.push(scene);
  }

  reset(): void {
    const distance = (this.radius / Math.sin((this.camera.fov * Math.PI) / 360)) * 1.02;
    this.camera.position.copy(new Vector3(0.55, 0.35, 1).normalize().multiplyScalar(distance));
    this.controls.target.set(0, 0, 0);
    this.controls.update();
    this.render();
  }

  /** Comes near a place of the surface, seen from outside. */
  flyTo(place: Vector3, outwards: Vector3): void {
    const root = this.roots[0]!;
    const target = place.clone().applyEuler(root.rotation), from = outwards.clone().applyEuler(root.rotation).normalize();
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(from, 2.6 * this.radius);
    this.controls.update();
    this.render();
  }

  /** Sets up what has its z axis upwards, as scanners of the ground write it, or its y axis. */
  stand(z_up: boolean): void {
    for (const root of this.roots) root.rotation.x = z_up ? -Math.PI / 2 : 0;
    this.render();
  }

  /** Looks from where another canvas looks. */
  follow(other: Tiles): void {
    this.camera.position.copy(other.camera.position);
    this.camera.quaternion.copy(other.camera.quaternion);
    this.controls.target.copy(other.controls.target);
    this.render();
  }

  render(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.place;
    if (clientWidth === 0 || clientHeight === 0) return;
    // The page's style makes room for the rows and sets what is written over the tiles.
    const columns = this.columns(clientWidth);
    this.place.style.setProperty("--columns", String(columns));
    this.place.style.setProperty("--rows", String(Math.ceil(this.scenes.length / columns)));
    this.renderer.setSize(clientWidth, clientHeight);
    this.draw();
  }

  /** All tiles in one row, or in as few rows as leave each wide enough for its label. */
  private columns(width: number): number {
    const rows = Math.ceil(this.scenes.length / Math.max(1, Math.floor(width / least_tile_px)));
    return Math.max(1, Math.ceil(this.scenes.length / rows));
  }

  private draw(): void {
    const { clientWidth, clientHeight } = this.place;
    if (clientWidth === 0 || this.scenes.length === 0) return;
    const columns = this.columns(clientWidth);
    const width = clientWidth / columns, height = clientHeight / Math.ceil(this.scenes.length / columns);
    const seen = height - this.label_px;
    this.camera.aspect = width / seen;
    this.camera.zoom = Math.min(1, this.camera.aspect);
    this.camera.updateProjectionMatrix();
    const away = this.camera.position.distanceTo(this.controls.target);
    this.fog.near = away - this.radius;
    this.fog.far = away + 0.8 * this.radius;
    this.renderer.setScissorTest(true);
    this.scenes.forEach((scene, n) => {
      const left = (n % columns) * width, bottom = clientHeight - (Math.floor(n / columns) + 1) * height;
      this.renderer.setViewport(left, bottom, width, seen);
      this.renderer.setScissor(left, bottom, width, height);
      this.renderer.render(scene, this.camera);
    });
  }
}

