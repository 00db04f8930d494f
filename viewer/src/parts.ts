// The things in the picture: samples, control net, curve or surface, comb, iso-lines.
import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { deviationColour, light, signedColour } from "./colours";
import type { ReportData, SplineData } from "./data";
import { evaluate, piecesFor, places } from "./spline";

export type SurfaceMap = "plain" | "zebra" | "gaussian" | "mean";

/** Coordinates with a zero third one in the plane. */
export function inSpace(values: ArrayLike<number>, dim: number): Float32Array {
  const count = values.length / dim;
  const result = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) for (let d = 0; d < Math.min(dim, 3); ++d) result[3 * i + d] = values[i * dim + d];
  return result;
}

/** A round dot for points. */
function disc(): THREE.Texture {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d")!;
  pen.beginPath();
  pen.arc(32, 32, 29, 0, 2 * Math.PI);
  pen.fillStyle = "#fff";
  pen.fill();
  return new THREE.CanvasTexture(canvas);
}

const dot = disc();

export function makeDots(positions: Float32Array, size: number): THREE.Points<THREE.BufferGeometry, THREE.PointsMaterial> {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  const material = new THREE.PointsMaterial({ size, sizeAttenuation: false, map: dot, alphaTest: 0.5, transparent: false });
  return new THREE.Points(geometry, material);
}

export function makeSamples(data: ReportData, top: number) {
  const count = data.deviations.length;
  const points = makeDots(inSpace(data.samples, data.dim), count > 20000 ? 1.8 : count > 2000 ? 3.2 : 5.5);
  const colours = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) colours.set(light(deviationColour(data.deviations[i], top, data.tolerance)), 3 * i);
  points.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  points.material.vertexColors = true;
  return points;
}

/** Index pairs of the lines along every axis of a net. */
function netLines(shape: number[]): number[] {
  const [n0, n1 = 1, n2 = 1] = shape;
  const at = (i: number, j: number, k: number) => (i * n1 + j) * n2 + k;
  const lines: number[] = [];
  for (let i = 0; i < n0; ++i)
    for (let j = 0; j < n1; ++j)
      for (let k = 0; k < n2; ++k) {
        if (i + 1 < n0) lines.push(at(i, j, k), at(i + 1, j, k));
        if (j + 1 < n1) lines.push(at(i, j, k), at(i, j + 1, k));
        if (k + 1 < n2) lines.push(at(i, j, k), at(i, j, k + 1));
      }
  return lines;
}

/** Control polygon or net with its points. */
export class Net {
  readonly group = new THREE.Group();
  private readonly positions: THREE.BufferAttribute;

  constructor(spline: SplineData) {
    const positions = inSpace(spline.control, spline.dim);
    const dots = makeDots(positions, spline.shape.length > 1 && positions.length > 3000 ? 2.5 : 5);
    this.positions = dots.geometry.getAttribute("position") as THREE.BufferAttribute;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", this.positions);
    geometry.setIndex(netLines(spline.shape));
    this.group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial()), dots);
  }
  move(control: Float32Array, dim: number) {
    this.positions.array.set(inSpace(control, dim));
    this.positions.needsUpdate = true;
  }
  colour(colour: string) {
    this.group.traverse((part) => {
      const material = (part as THREE.Points).material as THREE.PointsMaterial | undefined;
      material?.color.set(colour);
    });
  }
}

/** A curve as a line of some width, and its curvature comb. */
export class CurvePart {
  readonly group = new THREE.Group();
  readonly comb = new THREE.Group();
  private readonly line: Line2;
  private readonly t: number[];

  constructor(private readonly data: ReportData) {
    this.t = places(data.spline, 0, piecesFor(data.spline, 0, 1200));
    this.line = new Line2(new LineGeometry(), new LineMaterial({ linewidth: 2.5 }));
    this.group.add(this.line);
    this.move(data.spline.control);
    if (data.dim === 2 && !data.graph) this.makeComb();
  }
  move(control: Float32Array) {
    const points = inSpace(evaluate(this.data.spline, [this.t], [0], control), this.data.dim);
    this.line.geometry.dispose();
    this.line.geometry = new LineGeometry();
    this.line.geometry.setPositions(points);
  }
  colour(line: string, comb: string) {
    this.line.material.color.set(line);
    this.comb.traverse((part) => ((part as THREE.LineSegments).material as THREE.LineBasicMaterial | undefined)?.color.set(comb));
  }
  private makeComb() {
    const { spline } = this.data;
    const t = places(spline, 0, piecesFor(spline, 0, 300));
    const [point, first, second] = [0, 1, 2].map((order) => evaluate(spline, [t], [order]));
    const teeth: number[] = [];
    const tips: number[] = [];
    const curvature: number[] = [];
    let longest = 0;
    let reach = 0;
    for (let i = 0; i < t.length; ++i) {
      const speed = Math.hypot(first[2 * i], first[2 * i + 1]);
      const k = speed > 0 ? (first[2 * i] * second[2 * i + 1] - first[2 * i + 1] * second[2 * i]) / speed ** 3 : 0;
      curvature.push(k);
      longest = Math.max(longest, Math.abs(k));
      reach = Math.max(reach, Math.abs(point[2 * i]), Math.abs(point[2 * i + 1]));
    }
    if (!(longest > 0)) return;
    // the longest tooth a fifth of the picture: the root keeps a sharp nose from hiding the rest
    const scale = (0.2 * reach) / Math.sqrt(longest);
    for (let i = 0; i < t.length; ++i) {
      const speed = Math.hypot(first[2 * i], first[2 * i + 1]) || 1;
      const length = Math.sign(curvature[i]) * scale * Math.sqrt(Math.abs(curvature[i]));
      const tip = [point[2 * i] + (length * first[2 * i + 1]) / speed, point[2 * i + 1] - (length * first[2 * i]) / speed];
      teeth.push(point[2 * i], point[2 * i + 1], 0, tip[0], tip[1], 0);
      if (i > 0) tips.push(...tips.slice(-3), tip[0], tip[1], 0);
      else tips.push(tip[0], tip[1], 0);
      if (i === 0) tips.push(tip[0], tip[1], 0);
    }
    for (const lines of [teeth, tips]) {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", new THREE.Float32BufferAttribute(lines, 3));
      const opacity = lines === teeth ? 0.45 : 0.9;
      this.comb.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity })));
    }
  }
}

const zebra = {
  vertexShader: `varying vec3 n; varying vec3 p;
    void main() { n = normalMatrix * normal; vec4 q = modelViewMatrix * vec4(position, 1.0); p = q.xyz; gl_Position = projectionMatrix * q; }`,
  fragmentShader: `varying vec3 n; varying vec3 p; uniform vec3 light; uniform vec3 dark;
    void main() { vec3 m = normalize(n); if (!gl_FrontFacing) m = -m;
      vec3 r = reflect(normalize(p), m);
      float s = sin(26.0 * r.y); float w = fwidth(26.0 * r.y);
      gl_FragColor = vec4(mix(dark, light, smoothstep(-w, w, s)), 1.0); }`,
};

/** Faces of a surface or volume: a grid of places for each. */
interface Face {
  fixed: [number, number] | null; // axis and parameter of a volume's face
  axes: [number, number];
}

/** A surface, or the faces and one section of a volume. */
export class SurfacePart {
  readonly group = new THREE.Group();
  readonly lines = new THREE.Group();
  /** Largest absolute curvature that the colours reach, per map. */
  readonly reach: Record<string, number> = {};
  private readonly meshes: THREE.Mesh<THREE.BufferGeometry, THREE.Material>[] = [];
  private readonly materials: Record<SurfaceMap, THREE.Material>;

  constructor(
    private readonly data: ReportData,
    section: number,
  ) {
    this.materials = {
      plain: new THREE.MeshStandardMaterial({ roughness: 0.62, metalness: 0.05, side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1 }),
      zebra: new THREE.ShaderMaterial({ ...zebra, side: THREE.DoubleSide, uniforms: { light: { value: new THREE.Color("#f4f6f8") }, dark: { value: new THREE.Color("#1d2a38") } } }),
      gaussian: new THREE.MeshStandardMaterial({ roughness: 0.8, vertexColors: true, side: THREE.DoubleSide }),
      mean: new THREE.MeshStandardMaterial({ roughness: 0.8, vertexColors: true, side: THREE.DoubleSide }),
    };
    this.build(data.spline.control, section);
  }

  build(control: Float32Array, section: number) {
    for (const part of [...this.meshes, ...(this.lines.children as THREE.LineSegments[])]) part.geometry.dispose();
    this.meshes.length = 0;
    this.group.clear();
    this.lines.clear();
    for (const face of this.faces(section)) this.addFace(face, control);
  }

  show(map: SurfaceMap, colour: string) {
    (this.materials.plain as THREE.MeshStandardMaterial).color.set(colour);
    for (const mesh of this.meshes) {
      if (map === "gaussian" || map === "mean") this.colourBy(mesh, map);
      mesh.material = this.materials[map];
    }
  }
  colourLines(colour: string) {
    this.lines.traverse((part) => ((part as THREE.LineSegments).material as THREE.LineBasicMaterial | undefined)?.color.set(colour));
  }

  private faces(section: number): Face[] {
    const { spline } = this.data;
    if (spline.shape.length === 2) return [{ fixed: null, axes: [0, 1] }];
    const faces: Face[] = [];
    for (let axis = 0; axis < 3; ++axis) {
      const t = places(spline, axis, 1);
      const axes = [0, 1, 2].filter((k) => k !== axis) as [number, number];
      const from = axis === 0 ? t[0] + section * (t[t.length - 1] - t[0]) : t[0];
      faces.push({ fixed: [axis, from], axes }, { fixed: [axis, t[t.length - 1]], axes });
    }
    return faces;
  }

  private addFace(face: Face, control: Float32Array) {
    const { spline } = this.data;
    const wanted = face.fixed ? 60 : 240;
    const parameters: number[][] = spline.shape.map(() => []);
    const pieces = face.axes.map((axis) => piecesFor(spline, axis, wanted));
    face.axes.forEach((axis, k) => (parameters[axis] = places(spline, axis, pieces[k])));
    if (face.fixed) parameters[face.fixed[0]] = [face.fixed[1]];
    if (face.fixed && face.fixed[0] !== 0) // the cut-away part of a volume is not drawn
      parameters[0] = this.cut(parameters[0]);
    const [rows, columns] = face.axes.map((axis) => parameters[axis].length);
    const derive = (u: number, v: number) => {
      const orders = spline.shape.map(() => 0);
      orders[face.axes[0]] = u;
      orders[face.axes[1]] = v;
      return inSpace(evaluate(spline, parameters, orders, control), spline.dim);
    };
    const position = derive(0, 0);
    const su = derive(1, 0);
    const sv = derive(0, 1);
    const normal = new Float32Array(position.length);
    const cross = new THREE.Vector3();
    const other = new THREE.Vector3();
    for (let i = 0; i < position.length; i += 3) {
      cross.set(su[i], su[i + 1], su[i + 2]).cross(other.set(sv[i], sv[i + 1], sv[i + 2])).normalize();
      cross.toArray(normal, i);
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(position, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normal, 3));
    const triangles: number[] = [];
    for (let i = 0; i + 1 < rows; ++i)
      for (let j = 0; j + 1 < columns; ++j) {
        const a = i * columns + j;
        triangles.push(a, a + columns, a + columns + 1, a, a + columns + 1, a + 1);
      }
    geometry.setIndex(triangles);
    geometry.userData = { su, sv, suu: () => derive(2, 0), suv: () => derive(1, 1), svv: () => derive(0, 2) };
    const mesh = new THREE.Mesh<THREE.BufferGeometry, THREE.Material>(geometry, this.materials.plain);
    this.meshes.push(mesh);
    this.group.add(mesh);
    this.addKnotLines(geometry.getAttribute("position") as THREE.BufferAttribute, rows, columns, pieces);
  }

  private section = 0;
  private cut(t: number[]): number[] {
    const from = t[0] + this.section * (t[t.length - 1] - t[0]);
    const rest = t.filter((x) => x > from);
    return [from, ...rest];
  }
  cutAt(section: number, control: Float32Array) {
    this.section = section;
    this.build(control, section);
  }

  /** Lines over the knots. */
  private addKnotLines(position: THREE.BufferAttribute, rows: number, columns: number, pieces: number[]) {
    const index: number[] = [];
    for (let i = 0; i < rows; ++i)
      for (let j = 0; j < columns; ++j) {
        const at = i * columns + j;
        if (j + 1 < columns && (i % pieces[0] === 0 || i + 1 === rows)) index.push(at, at + 1);
        if (i + 1 < rows && (j % pieces[1] === 0 || j + 1 === columns)) index.push(at, at + columns);
      }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", position);
    geometry.setIndex(index);
    this.lines.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.35 })));
  }

  private colourBy(mesh: THREE.Mesh<THREE.BufferGeometry, THREE.Material>, map: "gaussian" | "mean") {
    const data = mesh.geometry.userData;
    const key = `curvature-${map}`;
    if (!data[key]) {
      const normal = mesh.geometry.getAttribute("normal").array;
      const [suu, suv, svv] = [data.suu(), data.suv(), data.svv()];
      const values = new Float64Array(normal.length / 3);
      const dot = (a: ArrayLike<number>, b: ArrayLike<number>, i: number) => a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2];
      for (let k = 0; k < values.length; ++k) {
        const i = 3 * k;
        const [E, F, G] = [dot(data.su, data.su, i), dot(data.su, data.sv, i), dot(data.sv, data.sv, i)];
        const [L, M, N] = [dot(suu, normal, i), dot(suv, normal, i), dot(svv, normal, i)];
        const area = E * G - F * F;
        values[k] = area > 0 ? (map === "gaussian" ? (L * N - M * M) / area : (E * N - 2 * F * M + G * L) / (2 * area)) : 0;
      }
      data[key] = values;
    }
    const values = data[key] as Float64Array;
    const sorted = Float64Array.from(values, Math.abs).sort();
    const reach = sorted[Math.floor(0.97 * (sorted.length - 1))] || 1;
    this.reach[map] = Math.max(this.reach[map] ?? 0, reach);
    const colours = new Float32Array(3 * values.length);
    values.forEach((value, k) => colours.set(light(signedColour(value / reach)), 3 * k));
    mesh.geometry.setAttribute("color", new THREE.BufferAttribute(colours, 3));
  }
}
