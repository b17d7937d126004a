// Both surfaces in three dimensions: endocardium solid, epicardium translucent around it.
import {
  AmbientLight,
  BackSide,
  BufferAttribute,
  BufferGeometry,
  Color,
  DirectionalLight,
  DoubleSide,
  FrontSide,
  Group,
  LineBasicMaterial,
  LineSegments,
  Mesh,
  MeshBasicMaterial,
  MeshPhongMaterial,
  PerspectiveCamera,
  Quaternion,
  Raycaster,
  Scene,
  Sphere,
  Spherical,
  Vector2,
  Vector3,
  WebGLRenderer,
  type Intersection,
  type Material,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import type { Wall } from "./cycle";
import { colour, svg } from "./dom";
import type { Grid, Polar, PolarMap } from "./data";
import { colourOfSample } from "./polar";
import { say } from "./words";

interface Shown {
  wall: Wall;
  geometry: BufferGeometry;
  group: Group;
  wire: Mesh;
  /** Borders of the segments: pairs of edges whose middles are joined, and the lines. */
  borders: { edges: number[]; lines: LineSegments };
}

/** Directions from which one looks at the heart, in the world (LPS); base and apex along its own axis. */
export type ViewName = "anterior" | "left" | "inferior" | "base" | "apex";

const up = new Vector3(0, 1, 0);
const lit_colour = new Color("#ffe14d");

export class SurfaceScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(30, 1, 1, 4000);
  private readonly controls: OrbitControls;
  private readonly shown: Shown[];
  private readonly bounds: Sphere;
  /** Turned so that its long axis points upwards in the scene. */
  private readonly heart = new Group();
  private readonly cross: LineSegments;
  private waiting = false;
  private lit = 0;
  private map: PolarMap | null = null;
  private gate = 0;

  /** Throws when the browser has no WebGL. */
  constructor(
    private readonly place: HTMLElement,
    private readonly compass: SVGSVGElement,
    walls: Wall[],
    grid: Grid,
    private readonly polar: Polar | null,
  ) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "low-power" });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", say("Surfaces of the ventricle. Drag, or hold Shift and press the arrow keys, to turn."));
    place.prepend(canvas);

    const axis = new Vector3(grid.direction[2], grid.direction[5], grid.direction[8]).normalize();
    this.heart.quaternion.setFromUnitVectors(axis, up);
    this.scene.add(this.heart);
    this.shown = walls.map((wall) => this.addWall(wall));
    this.bounds = boundsOf(walls, this.heart.quaternion);
    this.cross = crossOf(grid);
    this.heart.add(this.cross);
    this.addLights();

    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.minDistance = this.bounds.radius * 1.2;
    this.controls.maxDistance = this.bounds.radius * 12;
    this.controls.addEventListener("change", () => this.render());
    this.look("anterior");
    new ResizeObserver(() => this.resize()).observe(place);
    addEventListener("beforeprint", () => this.draw());
  }

  private addWall(wall: Wall): Shown {
    const geometry = new BufferGeometry();
    const solid = wall.name === "endo";
    const look = { color: 0xffffff, vertexColors: true, shininess: 28, specular: 0x333a44 };
    const materials: Material[] = solid
      ? [new MeshPhongMaterial({ ...look, side: DoubleSide })]
      : [BackSide, FrontSide].map(
          (side) => glass(new MeshPhongMaterial({ ...look, side, transparent: true, depthWrite: false })),
        );
    const group = new Group();
    materials.forEach((material, order) => {
      const mesh = new Mesh(geometry, material);
      mesh.renderOrder = solid ? 0 : 1 + order;
      mesh.frustumCulled = false;
      group.add(mesh);
    });
    const wire = new Mesh(
      geometry,
      new MeshBasicMaterial({ color: solid ? 0xd8ecff : 0xffc9b3, wireframe: true, transparent: true, opacity: solid ? 0.4 : 0.25, depthWrite: false }),
    );
    wire.visible = false;
    wire.frustumCulled = false;
    wire.renderOrder = 3;
    group.add(wire);
    const lines = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color: solid ? 0xeaf4ff : 0xffe2d3, transparent: true, opacity: solid ? 0.75 : 0.5 }));
    lines.frustumCulled = false;
    lines.renderOrder = 4;
    group.add(lines);
    this.heart.add(group);
    return { wall, geometry, group, wire, borders: { edges: [], lines } };
  }

  /** Lights travel with the eye, so that no view is dark. */
  private addLights(): void {
    this.scene.add(new AmbientLight(0xffffff, 0.75), this.camera);
    for (const [x, y, z, strength] of [[-1, 1.4, 1.2, 2.1], [1.6, -0.4, 0.6, 0.6]] as const) {
      const light = new DirectionalLight(0xffffff, strength);
      light.position.set(x, y, z);
      this.camera.add(light, light.target);
    }
  }

  /** Looks at the heart from a side of the patient, its base upwards, or along its axis with anterior on top. */
  look(view: ViewName): void {
    const inScene = (x: number, y: number, z: number) => new Vector3(x, y, z).applyQuaternion(this.heart.quaternion);
    const anterior = inScene(0, -1, 0).setY(0).normalize();
    const from = {
      anterior: inScene(0, -1, 0),
      left: inScene(1, 0, 0),
      inferior: inScene(0, 0, -1),
      base: up.clone().addScaledVector(anterior, -0.001),
      apex: up.clone().negate().addScaledVector(anterior, 0.001),
    }[view];
    // Square to the long axis and a little from above.
    if (view !== "base" && view !== "apex") from.setY(0).normalize().setY(0.28);
    const distance = (this.bounds.radius / Math.sin((this.camera.fov * Math.PI) / 360)) * 0.92;
    this.camera.position.copy(this.bounds.center).addScaledVector(from.normalize(), distance);
    this.controls.target.copy(this.bounds.center);
    this.controls.update();
    this.render();
  }

  turn(sideways: number, upwards: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const around = new Spherical().setFromVector3(offset);
    around.theta += sideways;
    around.phi = Math.min(Math.max(around.phi + upwards, 0.05), Math.PI - 0.05);
    this.camera.position.copy(this.controls.target).add(offset.setFromSpherical(around));
    this.controls.update();
    this.render();
  }

  set wires(on: boolean) {
    for (const { wire } of this.shown) wire.visible = on;
    this.render();
  }

  /** Lights the vertices of a segment, 0: none. */
  light(segment: number): void {
    this.lit = segment;
    for (const shown of this.shown) this.paint(shown);
    this.render();
  }

  /** Paints a polar map on the endocardium, null: its plain colour. */
  paintMap(map: PolarMap | null): void {
    this.map = map;
    for (const shown of this.shown) this.paint(shown);
    this.render();
  }

  private hitBy(event: PointerEvent): Intersection | undefined {
    const box = this.renderer.domElement.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    return ray.intersectObjects(this.shown.filter((s) => s.group.visible).map((s) => s.group.children[0]!), false)[0];
  }

  /** Tells `point` the segment under the pointer, 0 when it leaves the heart. */
  followPointer(point: (segment: number) => void): void {
    const canvas = this.renderer.domElement;
    canvas.addEventListener("pointermove", (event) => {
      if (event.buttons) return;
      const hit = this.hitBy(event);
      const shown = hit && this.shown.find((s) => s.group.children[0] === hit.object);
      const segments = shown && this.segmentsOf(shown.wall);
      point((hit?.face && segments?.[hit.face.a]) || 0);
    });
    canvas.addEventListener("pointerleave", () => point(0));
  }

  /** Tells `go` the place in the world (LPS, mm) on a surface that is clicked on. Dragging turns and is no click. */
  followClicks(go: (world: [number, number, number]) => void): void {
    const canvas = this.renderer.domElement;
    let pressed: PointerEvent | null = null;
    canvas.addEventListener("pointerdown", (event) => (pressed = event));
    canvas.addEventListener("pointerup", (event) => {
      if (!pressed || Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) > 4) return;
      const hit = this.hitBy(event);
      if (hit) go(this.heart.worldToLocal(hit.point.clone()).toArray());
    });
  }

  /** Marks a place in the world (LPS, mm), seen through the surfaces. */
  markCursor(world: [number, number, number]): void {
    this.cross.position.set(...world);
    this.render();
  }

  private segmentsOf(wall: Wall): Uint8Array | null {
    return this.polar?.[wall.name][this.gate] ?? null;
  }

  private paint({ wall, geometry }: Shown): void {
    const position = geometry.getAttribute("position") as BufferAttribute | undefined;
    if (!position) return;
    let painted = geometry.getAttribute("color") as BufferAttribute | undefined;
    if (painted?.count !== position.count) {
      painted = new BufferAttribute(new Float32Array(position.count * 3), 3);
      geometry.setAttribute("color", painted);
    }
    const plain = new Color(colour[wall.name]);
    const segments = this.segmentsOf(wall);
    const samples = wall.name === "endo" && this.map ? this.polar?.samples[this.gate] : null;
    const colours = new Map<number, Color>();
    const mapped = (v: number): Color => {
      const sample = samples![2 * v]! + 256 * samples![2 * v + 1]!;
      let found = colours.get(sample);
      if (!found) colours.set(sample, (found = new Color(colourOfSample(this.map!, sample) ?? colour[wall.name])));
      return found;
    };
    for (let v = 0; v < position.count; ++v) {
      const { r, g, b } = this.lit > 0 && segments?.[v] === this.lit ? lit_colour : samples ? mapped(v) : plain;
      painted.setXYZ(v, r, g, b);
    }
    painted.needsUpdate = true;
  }

  /** Where the borders of the segments run: through the middles of the edges between two of them. */
  private findBorders({ wall, geometry, borders }: Shown): void {
    const segments = this.segmentsOf(wall);
    const triangles = geometry.index?.array;
    borders.edges = [];
    if (!segments || !triangles) return;
    for (let t = 0; t < triangles.length; t += 3) {
      const corners = [triangles[t]!, triangles[t + 1]!, triangles[t + 2]!];
      const cut = [0, 1, 2].filter((n) => segments[corners[n]!] !== segments[corners[(n + 1) % 3]!]);
      if (cut.length < 2) continue;
      // Where three segments meet two of the three lines say enough.
      for (const [a, b] of cut.length === 2 ? [[cut[0]!, cut[1]!]] : [[0, 1], [1, 2]])
        borders.edges.push(corners[a!]!, corners[(a! + 1) % 3]!, corners[b!]!, corners[(b! + 1) % 3]!);
    }
  }

  private drawBorders({ geometry, borders }: Shown): void {
    const position = geometry.getAttribute("position") as BufferAttribute;
    const count = borders.edges.length / 2;
    let points = borders.lines.geometry.getAttribute("position") as BufferAttribute | undefined;
    if (points?.count !== count) {
      points = new BufferAttribute(new Float32Array(3 * count), 3);
      borders.lines.geometry.setAttribute("position", points);
    }
    for (let n = 0; n < count; ++n) {
      const [a, b] = [borders.edges[2 * n]!, borders.edges[2 * n + 1]!];
      points.setXYZ(
        n,
        (position.getX(a) + position.getX(b)) / 2,
        (position.getY(a) + position.getY(b)) / 2,
        (position.getZ(a) + position.getZ(b)) / 2,
      );
    }
    points.needsUpdate = true;
  }

  /** The picture as it stands now, to be copied before the browser shows the next one. */
  drawn(): HTMLCanvasElement {
    this.renderer.render(this.scene, this.camera);
    return this.renderer.domElement;
  }

  /** A picture of the heart at a moment from a side, for paper. Leaves the scene as it was asked for last. */
  picture(phase: number, view: ViewName, width: number, height: number): HTMLCanvasElement {
    const canvas = document.createElement("canvas");
    canvas.width = width;
    canvas.height = height;
    const { clientWidth, clientHeight } = this.place;
    this.show(phase);
    this.fit(width / this.renderer.getPixelRatio(), height / this.renderer.getPixelRatio());
    this.look(view);
    this.renderer.render(this.scene, this.camera);
    canvas.getContext("2d")!.drawImage(this.renderer.domElement, 0, 0, width, height);
    if (clientWidth > 0 && clientHeight > 0) this.fit(clientWidth, clientHeight);
    return canvas;
  }

  show(phase: number): void {
    const gates = Math.max(...this.shown.map(({ wall }) => wall.meshes.length), 1);
    const gate = Math.round(phase) % gates;
    const turned = gate !== this.gate;
    this.gate = gate;
    for (const shown of this.shown) {
      const { wall, geometry, group } = shown;
      const now = wall.at(phase);
      group.visible = now !== null;
      if (!now) continue;
      const position = geometry.getAttribute("position") as BufferAttribute | undefined;
      if (position?.array.length === now.points.length) {
        (position.array as Float32Array).set(now.points);
        position.needsUpdate = true;
      } else {
        geometry.setAttribute("position", new BufferAttribute(now.points.slice(), 3));
      }
      if (turned || geometry.getAttribute("color")?.count !== now.points.length / 3) this.paint(shown);
      // The ray's first test: a sphere around a moving surface is soon too small.
      geometry.boundingSphere = null;
      const rewired = geometry.index?.array !== now.triangles;
      if (rewired) geometry.setIndex(new BufferAttribute(now.triangles, 1));
      geometry.computeVertexNormals();
      if (turned || rewired) this.findBorders(shown);
      this.drawBorders(shown);
    }
    this.render();
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.place;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.fit(clientWidth, clientHeight);
    this.draw();
  }

  private fit(width: number, height: number): void {
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    // A narrow panel must hold the heart too.
    this.camera.zoom = Math.min(1, this.camera.aspect);
    this.camera.updateProjectionMatrix();
  }

  private render(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.draw();
    });
  }

  private draw(): void {
    this.renderer.render(this.scene, this.camera);
    this.drawCompass();
  }

  private drawCompass(): void {
    const toEye = this.camera.matrixWorldInverse;
    const turn = this.heart.quaternion;
    const arms = [
      { letter: "L", direction: new Vector3(1, 0, 0).applyQuaternion(turn) },
      { letter: "P", direction: new Vector3(0, 1, 0).applyQuaternion(turn) },
      { letter: "S", direction: new Vector3(0, 0, 1).applyQuaternion(turn) },
      { letter: say("Base"), direction: up.clone() },
    ].map(({ letter, direction }) => ({ letter, at: direction.transformDirection(toEye) }));
    // What points at the eye has no length on the screen; its letter would hide the others.
    const visible = arms.filter(({ at }) => Math.hypot(at.x, at.y) > 0.2).sort((a, b) => a.at.z - b.at.z);
    this.compass.replaceChildren(
      ...visible.flatMap(({ letter, at }) => {
        const heart = letter === say("Base");
        const [x, y] = [at.x * 30, -at.y * 30];
        return [
          svg("line", { x1: 0, y1: 0, x2: x, y2: y, class: heart ? "arm heart" : "arm" }),
          svg("text", { x: x * (heart ? 1.4 : 1.25), y: y * (heart ? 1.4 : 1.25), class: heart ? "heart" : "" }, letter),
        ];
      }),
    );
  }
}

/**
 * Clear where one looks straight through, dense at its rim, so that the outline stays visible. Drawn a little behind
 * its place: at the base both surfaces may lie in one plane, and the solid one is to be seen there.
 */
function glass(material: MeshPhongMaterial): MeshPhongMaterial {
  material.polygonOffset = true;
  material.polygonOffsetFactor = 2;
  material.polygonOffsetUnits = 4;
  material.emissive.set(colour.epi).multiplyScalar(0.22);
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <opaque_fragment>",
      `float rim = 1.0 - abs(dot(normal, normalize(vViewPosition)));
      diffuseColor.a = mix(0.13, 0.6, rim * rim);
      #include <opaque_fragment>`,
    );
  };
  return material;
}

/** Three short lines along the axes of the stack. */
function crossOf({ direction }: Grid): LineSegments {
  const arm_mm = 7;
  const ends = [0, 1, 2].flatMap((axis) =>
    [-arm_mm, arm_mm].flatMap((length) => [0, 1, 2].map((row) => length * direction[3 * row + axis]!)),
  );
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(ends), 3));
  const lines = new LineSegments(geometry, new LineBasicMaterial({ color: 0xffffff, depthTest: false, transparent: true }));
  lines.renderOrder = 5;
  return lines;
}

function boundsOf(walls: Wall[], turn: Quaternion): Sphere {
  const points: Vector3[] = [];
  for (const wall of walls)
    for (const mesh of wall.meshes)
      for (let n = 0; mesh && n < mesh.world.length; n += 3)
        points.push(new Vector3(mesh.world[n], mesh.world[n + 1], mesh.world[n + 2]).applyQuaternion(turn));
  return new Sphere().setFromPoints(points);
}
