// Many instances of one chain of levels of detail, each drawn at the level its size on the screen asks for.
import {
  AmbientLight,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DynamicDrawUsage,
  Frustum,
  InstancedBufferAttribute,
  InstancedMesh,
  Matrix4,
  MeshLambertMaterial,
  PerspectiveCamera,
  Quaternion,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { unpack } from "../data";
import { byId, html } from "../dom";
import { readTransition, withCuts, type PackedTransition } from "./transition";
import { blendFor, levelFor, limitsOf, type Blend } from "./choice";

interface Packed {
  low: number[];
  high: number[];
  fov_deg: number;
  edge_px: number;
  hysteresis_percent: number;
  instances: number;
  levels: { positions: string; triangles: string; mean_edge: number }[];
  transitions: PackedTransition[];
}

const most_instances = 1000;
const tints = [0xff8a5c, 0xf4e04d, 0x7fd068, 0x5aa9ff, 0xb48cff, 0xff7fb0].map((hex) => new Color(hex));
const plain = new Color(0xb9a58c);
const tintOf = (level: number) => tints[level % tints.length]!;

/** Triangles drawn once for all instances that show them. Each instance has its own t. */
class LevelMesh {
  readonly mesh: InstancedMesh;
  readonly growth = new InstancedBufferAttribute(new Float32Array(most_instances), 1);
  private count = 0;

  constructor(positions: Float32Array, triangles: Uint32Array, start: Float32Array | null) {
    const geometry = new BufferGeometry();
    const index = new BufferAttribute(triangles, 1);
    const normalsOf = (places: Float32Array) => {
      const shape = new BufferGeometry();
      shape.setAttribute("position", new BufferAttribute(places, 3));
      shape.setIndex(index);
      shape.computeVertexNormals();
      return shape.getAttribute("normal") as BufferAttribute;
    };
    geometry.setIndex(index);
    geometry.setAttribute("position", new BufferAttribute(positions, 3));
    geometry.setAttribute("normal", normalsOf(positions));
    geometry.setAttribute("startPosition", new BufferAttribute(start ?? positions, 3));
    geometry.setAttribute("startNormal", normalsOf(start ?? positions));
    this.growth.setUsage(DynamicDrawUsage);
    geometry.setAttribute("growth", this.growth);
    const material = new MeshLambertMaterial();
    material.onBeforeCompile = (shader) => {
      shader.vertexShader = shader.vertexShader
        .replace("#include <common>", "#include <common>\nattribute vec3 startPosition;\nattribute vec3 startNormal;\nattribute float growth;")
        .replace("#include <beginnormal_vertex>", "vec3 objectNormal = mix(startNormal, normal, growth);")
        .replace("#include <begin_vertex>", "vec3 transformed = mix(startPosition, position, growth);");
    };
    this.mesh = new InstancedMesh(geometry, material, most_instances);
    this.mesh.instanceMatrix.setUsage(DynamicDrawUsage);
    this.mesh.setColorAt(0, plain);
    this.mesh.instanceColor!.setUsage(DynamicDrawUsage);
    this.mesh.frustumCulled = false;
  }

  get triangles(): number {
    return this.mesh.geometry.index!.count / 3;
  }
  begin(): void {
    this.count = 0;
  }
  add(matrix: Matrix4, t: number, colour: Color): void {
    this.mesh.setMatrixAt(this.count, matrix);
    this.mesh.setColorAt(this.count, colour);
    this.growth.setX(this.count++, t);
  }
  /** Sends what this frame shows, and no more, to the graphics card. */
  end(): void {
    this.mesh.count = this.count;
    this.mesh.visible = this.count > 0;
    for (const attribute of [this.mesh.instanceMatrix, this.mesh.instanceColor!, this.growth]) {
      attribute.clearUpdateRanges();
      if (this.count > 0) attribute.addUpdateRange(0, this.count * attribute.itemSize);
      attribute.needsUpdate = this.count > 0;
    }
  }
}

/** Where an instance stands and how it turns: fixed numbers, so that every visit sees the same. */
interface Instance {
  place: Vector3;
  axis: Vector3;
  turn: number;
  speed: number;
  level: number | null;
}
function instancesOf(radius: number): Instance[] {
  const part = (n: number, step: number) => (0.5 + n * step) % 1;
  return Array.from({ length: most_instances }, (_, n) => {
    // Denser close by, so that every level is in use.
    const [a, b, c] = [part(n, 0.8191725134), part(n, 0.6710436067), part(n, 0.5497004779)];
    const away = radius * (5 + 130 * a * a);
    return {
      place: new Vector3((b - 0.5) * (radius * 5 + away * 1.1), (c - 0.5) * (radius * 3 + away * 0.6), -away),
      axis: new Vector3(a - 0.5, 1, c - 0.5).normalize(),
      turn: 6.28 * b,
      speed: 0.2 + 0.6 * c,
      level: null,
    };
  });
}

async function start(): Promise<void> {
  const data = JSON.parse(byId("data").textContent ?? "") as Packed;
  const middle = data.low.map((low, axis) => (low + data.high[axis]!) / 2);
  const side = data.low.map((low, axis) => data.high[axis]! - low);
  const diagonal = Math.hypot(...side);
  const place = async (packed: string) => {
    const steps = new Uint16Array((await unpack(packed)).buffer);
    return Float32Array.from(steps, (step, n) => data.low[n % 3]! - middle[n % 3]! + (side[n % 3]! * step) / 65535);
  };
  const levels = await Promise.all(
    data.levels.map(async (packed, n) => {
      const positions = await place(packed.positions), transition = data.transitions[n];
      const whole = new LevelMesh(positions, new Uint32Array((await unpack(packed.triangles)).buffer), null);
      if (!transition) return { whole, growing: whole };
      const { cuts, triangles, start } = await readTransition(transition, place);
      return { whole, growing: new LevelMesh(withCuts(positions, cuts, 3), triangles, start) };
    }),
  );

  const renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "high-performance" });
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  const view = byId("view");
  view.append(renderer.domElement);
  const camera = new PerspectiveCamera(data.fov_deg, 1, diagonal / 50, diagonal * 200);
  camera.position.set(0, 0, diagonal * 1.2);
  const controls = new OrbitControls(camera, renderer.domElement);
  controls.target.set(0, 0, -diagonal * 6);
  controls.update();
  const scene = new Scene();
  const meshes = [...new Set(levels.flatMap(({ whole, growing }) => [whole, growing]))];
  scene.add(new AmbientLight(0xffffff, 0.9), ...meshes.map((level) => level.mesh));
  for (const [x, y, z, strength] of [[-1, 1.5, 1, 2.2], [1, -0.5, 0.5, 0.6]] as const) {
    const light = new DirectionalLight(0xffffff, strength);
    light.position.set(x, y, z);
    scene.add(light);
  }

  const count = byId<HTMLInputElement>("count"), edge = byId<HTMLInputElement>("edge"), mode = byId<HTMLSelectElement>("mode");
  const tint = byId<HTMLInputElement>("tint"), move = byId<HTMLInputElement>("move");
  count.valueAsNumber = data.instances;
  edge.valueAsNumber = data.edge_px;
  const cells = levels.map((level, n) => {
    const swatch = html("span", { class: "swatch" });
    swatch.style.background = `#${tintOf(n).getHexString()}`;
    const cell = html("td", {});
    byId("levels").append(html("tr", {}, html("td", {}, swatch, String(n + 1)), html("td", {}, level.whole.triangles.toLocaleString("en")), cell));
    return cell;
  });

  const instances = instancesOf(diagonal / 2);
  const matrix = new Matrix4(), turn = new Quaternion(), one = new Vector3(1, 1, 1);
  const forward = new Vector3(), colour = new Color(), frustum = new Frustum(), ball = new Sphere(new Vector3(), diagonal / 2);
  let phase = 0;
  const counts = levels.map(() => 0);

  /** Chooses the level of every instance for this frame, and draws those in view; returns their triangles. */
  const choose = (): number => {
    const limits = limitsOf(data.levels.map((level) => level.mean_edge), diagonal, edge.valueAsNumber);
    const focal = view.clientHeight / (2 * Math.tan((camera.fov * Math.PI) / 360));
    const shown = count.valueAsNumber, how = mode.value, tinted = tint.checked;
    camera.updateMatrixWorld();
    camera.getWorldDirection(forward);
    frustum.setFromProjectionMatrix(matrix.multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    const here = camera.position.dot(forward);
    for (const mesh of meshes) mesh.begin();
    counts.fill(0);
    for (let n = 0; n < shown; ++n) {
      const instance = instances[n]!;
      const size = (diagonal * focal) / Math.max(instance.place.dot(forward) - here, diagonal / 100);
      let blend: Blend = { level: 0, t: 1 };
      if (how === "morph") blend = blendFor(limits, size, data.hysteresis_percent);
      if (how === "switch") {
        instance.level = levelFor(limits, size, instance.level, data.hysteresis_percent);
        blend = { level: instance.level, t: 1 };
      }
      ++counts[blend.level]!;
      ball.center.copy(instance.place);
      if (!frustum.intersectsSphere(ball)) continue;
      turn.setFromAxisAngle(instance.axis, instance.turn + phase * instance.speed);
      matrix.compose(instance.place, turn, one);
      const { whole, growing } = levels[blend.level]!;
      const next = tintOf(Math.min(blend.level + 1, levels.length - 1));
      (blend.t < 1 ? growing : whole).add(matrix, blend.t, tinted ? colour.copy(next).lerp(tintOf(blend.level), blend.t) : plain);
    }
    let triangles = 0;
    for (const mesh of meshes) {
      mesh.end();
      triangles += mesh.mesh.count * mesh.triangles;
    }
    return triangles;
  };

  const resize = () => {
    renderer.setSize(view.clientWidth, view.clientHeight);
    camera.aspect = view.clientWidth / view.clientHeight;
    camera.updateProjectionMatrix();
  };
  new ResizeObserver(resize).observe(view);
  resize();

  // Time that scripts take of a frame, the calls that tell the graphics card what to draw among them.
  let last = performance.now(), told = -Infinity, rated = last, frames = 0, busy = 0, triangles = 0;
  const tell = () => {
    counts.forEach((count, n) => (cells[n]!.textContent = String(count)));
    byId("count-now").textContent = count.value;
    byId("edge-now").textContent = `${edge.value} px`;
    Object.assign(document.documentElement.dataset, { triangles, counts: counts.join(" "), calls: renderer.info.render.calls, ready: "true" });
  };
  const rate = (now: number) => {
    const per_second = ((1000 * frames) / (now - rated)).toFixed(1), script = (busy / frames).toFixed(2);
    byId("rate").textContent = `${Math.round(Number(per_second))} frames/s, ${triangles.toLocaleString("en")} triangles in view, ${script} ms of script per frame`;
    Object.assign(document.documentElement.dataset, { rate: per_second, script });
    rated = now;
    frames = busy = 0;
  };
  for (const control of [count, edge, mode, tint, move]) control.addEventListener("input", () => (told = -Infinity));
  const frame = (now: number) => {
    if (move.checked) phase += Math.min(now - last, 100) / 1000;
    last = now;
    const begin = performance.now();
    triangles = choose();
    renderer.render(scene, camera);
    busy += performance.now() - begin;
    ++frames;
    // Text costs a layout of the page: ten times a second is enough for eyes.
    if (now - told > 100) tell(), (told = now);
    if (now - rated > 500) rate(now);
    requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
}

start().catch((error: unknown) => {
  byId("view").replaceChildren(html("p", { class: "message" }, `This page cannot be shown: ${String(error)}`));
  document.documentElement.dataset.ready = "true";
});
