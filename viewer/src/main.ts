// The report page: the picture, what can be shown in it, the account in words, the charts.
import type { LineSegments } from "three";
import "./style.css";
import { Charts } from "./charts";
import { deviationColour, divergingGradient, css, light, sequenceGradient } from "./colours";
import { readData, type ReportData } from "./data";
import { digits } from "./numbers";
import { CurvePart, inSpace, makeDots, makeSamples, Net, SurfacePart, type SurfaceMap } from "./parts";
import { Stage } from "./stage";

const element = <T extends HTMLElement>(id: string) => document.getElementById(id) as T;

function write(id: string, text: string) {
  element(id).textContent = text;
}

function account(data: ReportData) {
  document.title = `${data.title} – batten`;
  write("title", data.title);
  write("brief", data.brief);
  const verdict = element("verdict");
  verdict.textContent = data.verdict;
  verdict.className = data.met === null ? "plain" : data.met ? "good" : "bad";
  const list = document.createElement("dl");
  for (const [name, value] of data.words) {
    const term = document.createElement("dt");
    term.textContent = name;
    const text = document.createElement("dd");
    text.textContent = value;
    list.append(term, text);
  }
  const heading = document.createElement("h2");
  heading.textContent = "Account";
  element("account").append(heading, list);
  write("command", data.command);
  element("copy").addEventListener("click", async () => {
    try {
      await navigator.clipboard.writeText(data.command);
    } catch {
      // a page from disk may not reach the clipboard: the text is selected instead
      getSelection()?.selectAllChildren(element("command"));
      document.execCommand("copy");
    }
    write("copy", "Copied");
    setTimeout(() => write("copy", "Copy"), 1500);
  });
}

/** The deviation's scale, its tolerance marked; below it that of a curvature map. */
function legend(data: ReportData, top: number, curvature?: { name: string; reach: number }) {
  const root = element("legend");
  root.replaceChildren();
  const unit = data.unit ? ` ${data.unit}` : "";
  const scale = (gradient: string, low: string, high: string, name: string, mark?: { part: number; text: string }) => {
    const block = document.createElement("div");
    block.className = "scale";
    const title = document.createElement("span");
    title.textContent = name;
    const bar = document.createElement("i");
    bar.style.background = gradient;
    if (mark) {
      const tick = document.createElement("b");
      tick.style.left = `${100 * Math.min(1, mark.part)}%`;
      tick.title = mark.text;
      bar.append(tick);
    }
    const ends = document.createElement("span");
    ends.className = "ends";
    for (const text of [low, high]) {
      const end = document.createElement("span");
      end.textContent = text;
      ends.append(end);
    }
    block.append(title, bar, ends);
    root.append(block);
  };
  const tolerance = data.tolerance > 0 ? `, tolerance ${digits(data.tolerance)}` : "";
  scale(sequenceGradient(), "0", `${digits(top)}${unit}`, `Deviation: largest ${digits(data.maximum)}${unit} at sample ${data.worst}${tolerance}`, data.tolerance > 0 ? { part: data.tolerance / top, text: `tolerance ${digits(data.tolerance)}` } : undefined);
  if (curvature) scale(divergingGradient(), digits(-curvature.reach, 3), digits(curvature.reach, 3), curvature.name);
}

function toggle(name: string, on: boolean, change: (on: boolean) => void) {
  const label = document.createElement("label");
  const box = document.createElement("input");
  box.type = "checkbox";
  box.checked = on;
  box.addEventListener("change", () => change(box.checked));
  label.append(box, document.createTextNode(name));
  element("controls").append(label);
  change(on);
}

function start() {
  const data = readData();
  account(data);
  const flat = data.dim < 3;
  const top = Math.max(data.maximum, data.tolerance) || 1;
  const charts = new Charts(data, element("charts"));
  let stage: Stage;
  try {
    stage = new Stage(element<HTMLCanvasElement>("view"), flat);
  } catch {
    element("failure").hidden = false;
    write("failure", "This browser shows no WebGL picture; the account and the charts stand beside.");
    legend(data, top);
    charts.draw();
    return;
  }
  const samplePlaces = inSpace(data.samples, data.dim);
  const samples = makeSamples(data, top);
  const net = new Net(data.spline);
  const curve = data.spline.shape.length === 1 ? new CurvePart(data) : null;
  const surface = curve ? null : new SurfacePart(data, 0);
  if (flat) {
    samples.material.depthTest = false; // over the line that they lie on
    samples.renderOrder = 3;
  }
  stage.scene.add(samples, net.group);
  if (curve) stage.scene.add(curve.group, curve.comb);
  if (surface) stage.scene.add(surface.group, surface.lines);
  const ring = makeDots(new Float32Array(3), 13);
  ring.material.depthTest = false;
  ring.renderOrder = 9;
  const core = makeDots(new Float32Array(3), 8);
  core.material.depthTest = false;
  core.renderOrder = 10;
  stage.scene.add(ring, core);

  let map: SurfaceMap = "plain";
  const look = () => {
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    stage.ground(colour("--stage"));
    net.colour(colour("--net"));
    curve?.colour(colour("--ink"), colour("--comb"));
    surface?.show(map, colour("--surface"));
    surface?.colourLines(colour("--ink"));
    ring.material.color.set(colour("--ink"));
    const names = { gaussian: "Gaussian curvature", mean: "Mean curvature" } as const;
    legend(data, top, surface && (map === "gaussian" || map === "mean") ? { name: names[map], reach: surface.reach[map] } : undefined);
    stage.draw();
  };

  const place = (shownAt: number): [number, number, number] => [samplePlaces[3 * shownAt], samplePlaces[3 * shownAt + 1], samplePlaces[3 * shownAt + 2]];
  const indexOf = (shownAt: number) => (data.shown ? data.shown[shownAt] : shownAt);
  const worstAt = data.shown ? data.shown.indexOf(data.worst) : data.worst;
  const read = (shownAt: number) => {
    const index = indexOf(shownAt);
    const values = Array.from({ length: data.dim }, (_, d) => digits(data.samples[shownAt * data.dim + d] / data.stretch[d] + data.centre[d], 8));
    const deviation = data.deviations[shownAt];
    const part = data.tolerance > 0 ? `, ${Math.round((100 * deviation) / data.tolerance)} % of the tolerance` : "";
    element("picked").hidden = false;
    write("picked", `${index === data.worst ? "Worst sample, " : "Sample "}${index}: (${values.join(", ")}), deviation ${digits(deviation)}${data.unit ? ` ${data.unit}` : ""}${part}`);
    for (const mark of [ring, core]) {
      mark.geometry.getAttribute("position").array.set(place(shownAt));
      mark.geometry.getAttribute("position").needsUpdate = true;
    }
    core.material.color.setRGB(...light(deviationColour(deviation, top, data.tolerance)));
    stage.draw();
  };

  const draw = (part: { visible: boolean }) => (on: boolean) => {
    part.visible = on;
    stage.draw();
  };
  toggle("samples", true, draw(samples));
  toggle(data.spline.shape.length === 1 ? "control polygon" : "control net", curve !== null, draw(net.group));
  if (curve) toggle("curve", true, draw(curve.group));
  const places = () => {
    const teeth = curve?.comb.visible ? curve.comb.children.map((lines) => (lines as LineSegments).geometry.getAttribute("position").array) : [];
    return [samplePlaces, ...(flat ? [inSpace(data.spline.control, data.dim)] : []), ...teeth];
  };
  if (curve && curve.comb.children.length > 0)
    toggle("curvature comb", false, (on) => {
      curve.comb.visible = on;
      stage.frame(places());
    });
  if (surface) {
    toggle(data.spline.shape.length === 2 ? "surface" : "faces", true, draw(surface.group));
    toggle("knot lines", data.spline.control.length < 3e4, draw(surface.lines));
    const select = document.createElement("select");
    select.setAttribute("aria-label", "What the surface's colours show");
    const curvatures = data.graph ? [] : [["gaussian", "Gaussian curvature"], ["mean", "mean curvature"]];
    for (const [value, name] of [["plain", "plain"], ["zebra", "zebra stripes"], ...curvatures]) select.add(new Option(name, value));
    select.addEventListener("change", () => {
      map = select.value as SurfaceMap;
      look();
    });
    element("controls").append(select);
  }
  if (surface && data.spline.shape.length === 3) {
    const label = document.createElement("label");
    label.textContent = "cut away ";
    const slider = document.createElement("input");
    slider.type = "range";
    slider.max = "95";
    slider.value = "0";
    slider.addEventListener("input", () => {
      surface.cutAt(Number(slider.value) / 100, data.spline.control);
      look();
    });
    label.append(slider);
    element("controls").append(label);
  }
  const button = document.createElement("button");
  button.type = "button";
  button.textContent = "Worst sample";
  const showWorst = () => {
    if (worstAt < 0) return;
    stage.goTo(...place(worstAt));
    read(worstAt);
  };
  button.addEventListener("click", showWorst);
  const whole = document.createElement("button");
  whole.type = "button";
  whole.textContent = "Whole picture";
  whole.addEventListener("click", () => stage.reset());
  element("controls").append(button, whole);
  if (data.shown) {
    const note = document.createElement("p");
    note.textContent = `${data.deviations.length} of ${data.count} samples are shown, evenly thinned; the numbers are of all.`;
    element("controls").append(note);
  }
  addEventListener("keydown", (event) => {
    if ((event.key === "w" || event.key === "W") && !(event.target as HTMLElement).closest("input, select")) showWorst();
  });
  stage.onPick((at) => {
    const found = stage.nearest(samplePlaces, at, 14);
    if (found !== null) read(found);
  });

  if (data.frames.length > 1) player(data, (control) => {
    net.move(control, data.dim);
    curve?.move(control);
    surface?.build(control, 0);
    look();
  });

  stage.frame(places());
  if (worstAt >= 0) read(worstAt);
  look();
  charts.draw();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    look();
    charts.draw();
  });
  let width = innerWidth;
  addEventListener("resize", () => {
    if (width !== innerWidth) charts.draw();
    width = innerWidth;
  });
  // where a sample is drawn, for those who drive the page
  (window as unknown as { batten: unknown }).batten = { worst: worstAt, onScreen: (shownAt: number) => stage.onScreen(...place(shownAt)), css };
}

/** The iterations one after the other. */
function player(data: ReportData, show: (control: Float32Array) => void) {
  element("player").hidden = false;
  const slider = element<HTMLInputElement>("iteration");
  const play = element<HTMLButtonElement>("play");
  const last = data.frames.length - 1;
  slider.max = String(last);
  const go = (k: number) => {
    slider.value = String(k);
    write("iteration-name", `iteration ${data.frames[k].iteration}`);
    show(data.frames[k].control);
  };
  let timer = 0;
  const stop = () => {
    clearInterval(timer);
    timer = 0;
    play.textContent = "Play";
  };
  slider.addEventListener("input", () => {
    stop();
    go(Number(slider.value));
  });
  play.addEventListener("click", () => {
    if (timer) return stop();
    play.textContent = "Pause";
    if (Number(slider.value) === last) go(0);
    timer = window.setInterval(() => (Number(slider.value) < last ? go(Number(slider.value) + 1) : stop()), 140);
  });
  slider.value = String(last);
  write("iteration-name", `iteration ${data.frames[last].iteration}`);
}

start();
