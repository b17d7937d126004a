// A small scene in three dimensions that is turned with the pointer and drawn when something in it has changed.
import { AmbientLight, DirectionalLight, Group, PerspectiveCamera, Scene, Sphere, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import type { Grid } from "./data";
import { html } from "./dom";

const view_deg = 30;

export class Stage3d {
  readonly frame: HTMLElement;
  readonly camera = new PerspectiveCamera(view_deg, 1, 1, 4000);
  /** In the world (LPS, mm), turned so that the long axis points upwards. */
  readonly heart = new Group();
  readonly radius: number;
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private waiting = false;

  /** Throws when the browser has no WebGL. All `points` (world, three numbers each) fit into the frame. */
  constructor(grid: Grid, points: ArrayLike<number>, label: string) {
    this.renderer = new WebGLRenderer({ antialias: true, alpha: true, powerPreference: "low-power" });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    const axis = new Vector3(grid.direction[2], grid.direction[5], grid.direction[8]).normalize();
    this.heart.quaternion.setFromUnitVectors(axis, new Vector3(0, 1, 0));
    const light = new DirectionalLight(0xffffff, 1.8);
    light.position.set(-1, 1.4, 1.2);
    this.camera.add(light, light.target);
    this.scene.add(this.heart, new AmbientLight(0xffffff, 0.9), this.camera);

    const corners: Vector3[] = [];
    for (let n = 0; n < points.length; n += 3)
      corners.push(new Vector3(points[n], points[n + 1], points[n + 2]).applyQuaternion(this.heart.quaternion));
    const bounds = new Sphere().setFromPoints(corners);
    this.radius = bounds.radius;
    const away = (this.radius / Math.sin(((view_deg / 2) * Math.PI) / 180)) * 0.95;
    this.camera.position.copy(bounds.center).add(new Vector3(0, 0.28, 1).normalize().multiplyScalar(away));

    const canvas = this.renderer.domElement;
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", label);
    this.frame = html("div", { class: "frame3d" }, canvas);
    const controls = new OrbitControls(this.camera, canvas);
    controls.enablePan = false;
    controls.minDistance = this.radius * 1.2;
    controls.maxDistance = this.radius * 12;
    controls.target.copy(bounds.center);
    controls.update();
    controls.addEventListener("change", () => this.render());
    new ResizeObserver(() => this.resize()).observe(this.frame);
  }

  get canvas(): HTMLCanvasElement {
    return this.renderer.domElement;
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.frame;
    if (clientWidth === 0) return;
    this.renderer.setSize(clientWidth, clientHeight);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.zoom = Math.min(1, this.camera.aspect);
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
  }

  /** Draws with the next picture of the screen. */
  render(): void {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }
}
