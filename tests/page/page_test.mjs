// The report page in headless Chromium: drawn, moved, read and quiet. BATTEN names the command, PAGES (optional) a folder for screenshots.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

const root = path.resolve(import.meta.dirname ?? path.dirname(new URL(import.meta.url).pathname), "../..");
const { chromium } = await import(pathToFileURL(path.join(root, "viewer/node_modules/playwright-core/index.mjs")).href);
const folder = mkdtempSync(path.join(tmpdir(), "batten-page-"));
const shots = process.env.PAGES;
if (shots) mkdirSync(shots, { recursive: true });
const guard = 600_000; // milliseconds: ends what hangs, never what a busy machine slows
let browser;

const batten = (...words) => execFileSync(process.env.BATTEN, words.map(String), { cwd: folder, stdio: ["ignore", "pipe", "pipe"] }).toString();

before(async () => {
  browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: ["--no-sandbox", "--enable-unsafe-swiftshader"], timeout: guard });
});
after(() => browser.close());

/** Opens a report; every word on the console but the software renderer's own, every error and every request is collected. */
async function open(name, look = {}) {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, ...look });
  page.setDefaultTimeout(guard);
  page.said = [];
  page.on("console", (message) => {
    if (!/GL Driver Message|GPU stall|WebGL.*fallback|swiftshader/i.test(message.text())) page.said.push(message.text());
  });
  page.on("pageerror", (error) => page.said.push(String(error)));
  page.on("request", (request) => {
    if (!/^(file:|data:|blob:)/.test(request.url())) page.said.push(`request ${request.url()}`);
  });
  await page.goto(pathToFileURL(path.join(folder, name)).href);
  await until(page, () => globalThis.batten !== undefined, "the page starts");
  await drawn(page);
  return page;
}

const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(done)))));

/** Waits, frame by frame, until the page says so; its own waiting would need an eval, which the page forbids. */
async function until(page, holds, words) {
  const start = Date.now();
  while (!(await page.evaluate(holds))) {
    assert.ok(Date.now() - start < guard, words);
    await drawn(page);
  }
}

/** Pixels of the canvas as text, and how many differ from the corner's. */
async function pixels(page) {
  await drawn(page);
  return page.evaluate(() => {
    const view = document.getElementById("view");
    const copy = document.createElement("canvas");
    copy.width = view.width;
    copy.height = view.height;
    const pen = copy.getContext("2d");
    pen.drawImage(view, 0, 0);
    const data = pen.getImageData(0, 0, copy.width, copy.height).data;
    let drawnPixels = 0;
    let sum = 0;
    for (let i = 0; i < data.length; i += 4) {
      if (data[i] !== data[0] || data[i + 1] !== data[1] || data[i + 2] !== data[2]) ++drawnPixels;
      sum = (sum * 31 + data[i] + 3 * data[i + 1] + 7 * data[i + 2]) >>> 0;
    }
    return { drawn: drawnPixels, sum, context: view.getContext("webgl2") !== null };
  });
}

async function check(page, summary) {
  const seen = await pixels(page);
  assert.ok(seen.context, "a WebGL context");
  assert.ok(seen.drawn > 2000, `something is drawn: ${seen.drawn} pixels`);
  const legend = await page.textContent("#legend");
  assert.ok(legend.includes(`largest ${Number(summary.max_deviation.toPrecision(6))}`), legend);
  assert.deepEqual(page.said, []);
}

/** Clicks where the worst sample is drawn and expects its number. */
async function clickWorst(page, summary) {
  await page.click("#controls button"); // it comes to the middle, nearer
  await drawn(page);
  const [x, y] = await page.evaluate(() => globalThis.batten.onScreen(globalThis.batten.worst));
  const box = await page.locator("#view").boundingBox();
  await page.mouse.click(box.x + x, box.y + y);
  assert.match(await page.textContent("#picked"), new RegExp(`^Worst sample, ${summary.worst_sample}:`));
}

const shot = async (page, name) => shots && page.screenshot({ path: path.join(shots, `${name}.png`) });
const summaryOf = (name) => JSON.parse(readFileSync(path.join(folder, name), "utf8"));

test("a curve with its iterations", async () => {
  batten("generate", "rose", "-o", "rose.csv");
  batten("fit", "rose.csv", "-n", 60, "--method", "lspia", "--initial", "data", "--history", "--report", "curve.html", "--summary", "curve.json", "-q");
  const summary = summaryOf("curve.json");
  const page = await open("curve.html");
  await check(page, summary);
  const end = await pixels(page);
  await page.locator("#iteration").fill("0");
  const start = await pixels(page);
  assert.notEqual(start.sum, end.sum, "the slider moves the curve");
  assert.equal(await page.textContent("#iteration-name"), "iteration 0");
  await page.click("#play");
  await until(page, () => Number(document.getElementById("iteration").value) > 0, "the player plays");
  await page.click("#play");
  await page.locator("#iteration").fill(await page.getAttribute("#iteration", "max"));
  const before = await pixels(page);
  await page.getByLabel("curvature comb").check();
  assert.notEqual((await pixels(page)).sum, before.sum, "the comb is drawn");
  assert.equal(await page.locator("#charts canvas").count(), 2);
  await page.focus("#view");
  await page.keyboard.press("ArrowLeft");
  await page.keyboard.press("+");
  assert.notEqual((await pixels(page)).sum, before.sum, "keys move the picture");
  await page.keyboard.press("r");
  await clickWorst(page, summary);
  assert.match(await page.textContent("#command"), /^batten fit rose\.csv -n 60 --method lspia/);
  assert.deepEqual(page.said, []);
});

test("the wing, for the documents", async () => {
  batten("generate", "naca2412", "-o", "naca2412.csv");
  batten("fit", "naca2412.csv", "--tolerance", 0.0005, "--interpolate", "ends", "--report", "wing.html", "--summary", "wing.json", "--unit", "m", "-q");
  const page = await open("wing.html", { viewport: { width: 1280, height: 720 } });
  await page.getByLabel("curvature comb").check();
  await check(page, summaryOf("wing.json"));
  assert.match(await page.textContent("#verdict"), /^Tolerance 0\.0005: met/);
  await shot(page, "wing");
});

test("a terrain", async (t) => {
  const terrain = path.join(root, "../shared/data/terrain344x403.npy");
  if (!existsSync(terrain)) {
    const words = "shared data absent: terrain344x403.npy";
    assert.ok(!process.env.CI, words);
    console.log(`NOT RUN: page, a terrain: ${words}`);
    return t.skip(words);
  }
  copyFileSync(terrain, path.join(folder, "terrain.npy"));
  batten("fit", "terrain.npy", "--heights", "--spacing", "60,60", "--control-points", "90x100", "--report", "terrain.html", "--summary", "terrain.json", "-q");
  const page = await open("terrain.html");
  await check(page, summaryOf("terrain.json"));
  assert.match(await page.textContent("#controls"), /69[0-9]+ of 138632 samples are shown, evenly thinned/);
  await clickWorst(page, summaryOf("terrain.json"));
  await page.getByText("Whole picture").click();
  await page.getByLabel("samples").uncheck();
  const plain = await pixels(page);
  for (const map of ["zebra", "gaussian", "mean"]) {
    await page.selectOption("#controls select", map);
    assert.notEqual((await pixels(page)).sum, plain.sum, map);
  }
  assert.match(await page.textContent("#legend"), /Mean curvature/);
  await page.selectOption("#controls select", "plain");
  await shot(page, "terrain");
  assert.deepEqual(page.said, []);
});

test("a surface in the dark", async () => {
  batten("generate", "peaks", "-o", "peaks.npy");
  batten("fit", "peaks.npy", "--tolerance", 0.01, "--report", "peaks.html", "--summary", "peaks.json", "-q");
  const page = await open("peaks.html", { colorScheme: "dark" });
  await check(page, summaryOf("peaks.json"));
  await shot(page, "peaks-dark");
});

test("a small volume", async () => {
  const text = [];
  const steps = Array.from({ length: 9 }, (_, i) => i / 8);
  for (const u of steps) for (const v of steps) for (const w of steps) text.push([(1 + u) * Math.cos(1.5 * v), (1 + u) * Math.sin(1.5 * v), w + 0.3 * Math.sin(3 * u)].join(","));
  writeFileSync(path.join(folder, "block.csv"), text.join("\n") + "\n");
  batten("fit", "block.csv", "--grid", "9x9x9", "--control-points", "5x5x5", "--report", "block.html", "--summary", "block.json", "-q");
  const page = await open("block.html");
  await check(page, summaryOf("block.json"));
  const whole = await pixels(page);
  await page.locator("#controls input[type=range]").fill("60");
  assert.notEqual((await pixels(page)).sum, whole.sum, "the section moves");
  assert.deepEqual(page.said, []);
});

test("names are shown as text", async () => {
  const name = `a <script>alert(1)<\u002fscript> "b" 'c' & дуга.csv`.replaceAll("/", "");
  batten("generate", "naca2412", "-o", name);
  batten("fit", name, "-n", 12, "--report", "odd.html", "-q");
  const page = await open("odd.html");
  assert.equal(await page.textContent("#title"), name.slice(0, -4));
  assert.ok((await page.textContent("#command")).includes("<script>"));
  assert.equal(await page.evaluate(() => document.querySelectorAll("script").length), await page.evaluate(() => [...document.scripts].filter((s) => s.id === "batten-data" || s.type === "module").length));
  assert.deepEqual(page.said, []);
});

test("a narrow page and a printed one", async () => {
  batten("generate", "naca2412", "-o", "n.csv");
  batten("fit", "n.csv", "-t", 0.001, "--report", "n.html", "-q");
  const page = await open("n.html", { viewport: { width: 390, height: 844 }, hasTouch: true });
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth), "no sideways scrolling");
  await shot(page, "narrow");
  const paper = await page.pdf();
  assert.ok(paper.length > 20000);
  assert.deepEqual(page.said, []);
});

test("the page is small", () => {
  const empty = readFileSync(path.join(root, "src/batten/report/page.html"));
  assert.ok(empty.length < 1.5e6);
  assert.ok(statSync(path.join(folder, "n.html")).size < empty.length + 50000);
});

test("the checked-in page is what viewer/ builds", () => {
  const out = path.join(folder, "built");
  execFileSync("npx", ["--no-install", "vite", "build", "--outDir", out, "--logLevel", "error"], { cwd: path.join(root, "viewer"), stdio: "pipe" });
  assert.ok(readFileSync(path.join(out, "index.html"), "utf8") === readFileSync(path.join(root, "src/batten/report/page.html"), "utf8"), "run: npm run build in viewer/, and copy dist/index.html to src/batten/report/page.html");
});
