// The canvas: camera, light, turning and moving by mouse, touch and keys, picking a sample.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

export class Stage {
  readonly scene = new THREE.Scene();
  readonly renderer: THREE.WebGLRenderer;
  private readonly camera: THREE.OrthographicCamera;
  private readonly controls: OrbitControls;
  private readonly box = new THREE.Box3();
  private waiting = false;

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly flat: boolean,
  ) {
    // what was drawn stays readable: for printing, and for tests
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    this.camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -1e3, 1e3);
    this.camera.add(new THREE.DirectionalLight("#ffffff", 2.6));
    this.camera.children[0].position.set(0.9, 0.8, 0.7);
    this.scene.add(this.camera, new THREE.HemisphereLight("#ffffff", "#8a97a8", 0.8));
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableRotate = !flat;
    this.controls.zoomToCursor = true;
    if (flat) {
      this.controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
      this.controls.touches.ONE = THREE.TOUCH.PAN;
    }
    this.controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement!);
  }

  /** Frames the box of what matters and looks at it from a pleasant side. */
  frame(positions: ArrayLike<number>[]) {
    this.box.makeEmpty();
    const point = new THREE.Vector3();
    for (const list of positions) for (let i = 0; i + 2 < list.length; i += 3) this.box.expandByPoint(point.set(list[i], list[i + 1], list[i + 2]));
    this.reset();
  }

  reset() {
    const centre = this.box.getCenter(new THREE.Vector3());
    const size = this.box.getSize(new THREE.Vector3()).length() || 1;
    this.camera.up.set(0, this.flat ? 1 : 0, this.flat ? 0 : 1);
    const side = this.flat ? new THREE.Vector3(0, 0, 1) : new THREE.Vector3(-0.55, -0.8, 0.62).normalize();
    this.camera.position.copy(centre).addScaledVector(side, size);
    this.camera.near = -10 * size;
    this.camera.far = 10 * size;
    this.camera.zoom = 1;
    this.controls.target.copy(centre);
    this.controls.update();
    this.resize();
  }

  /** Width and height of the box as seen from the camera. */
  private extent(): [number, number] {
    this.camera.updateMatrixWorld();
    const inverse = this.camera.matrixWorldInverse;
    const seen = new THREE.Box3();
    const { min, max } = this.box;
    for (const x of [min.x, max.x]) for (const y of [min.y, max.y]) for (const z of [min.z, max.z]) seen.expandByPoint(new THREE.Vector3(x, y, z).applyMatrix4(inverse));
    const size = seen.getSize(new THREE.Vector3());
    return [size.x || 1, size.y || 1];
  }

  private view: [number, number] | null = null;
  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (width === 0 || height === 0 || this.box.isEmpty()) return;
    this.renderer.setSize(width, height, false);
    if (this.view === null || this.camera.zoom === 1) this.view = this.extent();
    const [w, h] = this.view;
    const free = this.flat ? 0.86 : 0.9;
    const scale = Math.max(w / width, h / height) / free / 2;
    this.camera.left = -scale * width;
    this.camera.right = scale * width;
    this.camera.top = scale * height;
    this.camera.bottom = -scale * height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  ground(colour: string) {
    this.scene.background = new THREE.Color(colour);
    this.draw();
  }

  /** Place of a point on the page, in pixels of the canvas. */
  onScreen(x: number, y: number, z: number): [number, number] {
    this.camera.updateMatrixWorld();
    const p = new THREE.Vector3(x, y, z).project(this.camera);
    return [((p.x + 1) / 2) * this.canvas.clientWidth, ((1 - p.y) / 2) * this.canvas.clientHeight];
  }

  /** Index of the point nearest to a place on the canvas, none beyond `reach` pixels; of several there, the frontmost. */
  nearest(positions: ArrayLike<number>, at: [number, number], reach: number): number | null {
    this.camera.updateMatrixWorld();
    const p = new THREE.Vector3();
    let best: number | null = null;
    let least = Infinity;
    for (let i = 0; i + 2 < positions.length; i += 3) {
      p.set(positions[i], positions[i + 1], positions[i + 2]).project(this.camera);
      const away = Math.hypot(((p.x + 1) / 2) * this.canvas.clientWidth - at[0], ((1 - p.y) / 2) * this.canvas.clientHeight - at[1]);
      const rank = away + p.z;
      if (away <= reach && rank < least) {
        least = rank;
        best = i / 3;
      }
    }
    return best;
  }

  /** Calls back for a click or tap, not for the end of a drag. */
  onPick(pick: (at: [number, number]) => void) {
    let down: [number, number] | null = null;
    this.canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    this.canvas.addEventListener("pointerup", (event) => {
      if (down === null || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5) return;
      const box = this.canvas.getBoundingClientRect();
      pick([event.clientX - box.left, event.clientY - box.top]);
    });
  }

  /** Moves a point to the middle and comes closer. */
  goTo(x: number, y: number, z: number) {
    const to = new THREE.Vector3(x, y, z);
    const shift = to.clone().sub(this.controls.target);
    this.controls.target.copy(to);
    this.camera.position.add(shift);
    this.camera.zoom = Math.max(this.camera.zoom, 4);
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  private onKey(event: KeyboardEvent) {
    const steps: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    const step = steps[event.key];
    if (event.key === "+" || event.key === "=" || event.key === "-") {
      this.camera.zoom *= event.key === "-" ? 1 / 1.2 : 1.2;
      this.camera.updateProjectionMatrix();
    } else if (event.key === "r" || event.key === "R") {
      this.reset();
    } else if (step && this.flat) {
      const by = (this.camera.right - this.camera.left) / this.camera.zoom / 12;
      const shift = new THREE.Vector3(by * step[0], by * step[1], 0);
      this.camera.position.add(shift);
      this.controls.target.add(shift);
      this.controls.update();
    } else if (step) {
      const away = this.camera.position.clone().sub(this.controls.target);
      away.applyAxisAngle(this.camera.up, -0.12 * step[0]);
      const across = new THREE.Vector3().crossVectors(this.camera.up, away).normalize();
      const tilted = away.clone().applyAxisAngle(across, -0.12 * step[1]);
      if (Math.abs(tilted.angleTo(this.camera.up) - Math.PI / 2) < Math.PI / 2 - 0.05) away.copy(tilted);
      this.camera.position.copy(this.controls.target).add(away);
      this.controls.update();
    } else {
      return;
    }
    event.preventDefault();
    this.draw();
  }
}
