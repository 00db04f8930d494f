// Convergence over the iterations, and how many samples are how far off.
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { css, deviationColour } from "./colours";
import type { ReportData } from "./data";
import { digits } from "./numbers";

interface Look {
  ink: string;
  faint: string;
  accent: string;
  second: string;
}

const font = "11px system-ui, sans-serif";

function axis(look: Look, rest: uPlot.Axis): uPlot.Axis {
  return { stroke: look.ink, font, labelFont: font, grid: { stroke: look.faint, width: 1 }, ticks: { stroke: look.faint, width: 1 }, ...rest };
}

/** Powers of ten, so many apart that about six fit. */
function decades(low: number, high: number): number[] {
  const [from, to] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const step = Math.max(1, Math.ceil((to - from) / 6));
  return Array.from({ length: Math.floor((to - from) / step) + 1 }, (_, k) => 10 ** (from + k * step));
}

const short = (x: number) => (x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5) ? x.toExponential(0) : digits(x, 3));

function convergence(data: ReportData, width: number, look: Look): uPlot.Options | null {
  if (!data.history || data.history.iteration.length < 2) return null;
  return {
    width,
    height: 190,
    legend: { show: true, live: false },
    cursor: { show: false },
    scales: { x: { time: false }, y: { distr: 3 } },
    axes: [axis(look, { label: "iteration", labelSize: 18, size: 34 }), axis(look, { size: 52, splits: (_, __, low, high) => decades(low, high), filter: (_, ticks) => ticks, values: (_, ticks) => ticks.map((x) => (x === null ? "" : short(x))) })],
    series: [{ label: "iteration" }, { label: "gradient", stroke: look.accent, width: 1.6, points: { show: false } }, { label: "largest deviation", stroke: look.second, width: 1.6, points: { show: false } }],
  };
}

const bins = 32;

function histogram(data: ReportData): [number[], number[]] {
  const top = data.maximum || 1;
  const counts = new Array<number>(bins).fill(0);
  for (const d of data.deviations) counts[Math.min(bins - 1, Math.floor((d / top) * bins))]++;
  return [counts.map((_, k) => ((k + 0.5) / bins) * top), counts];
}

export class Charts {
  private plots: uPlot[] = [];

  constructor(
    private readonly data: ReportData,
    private readonly root: HTMLElement,
  ) {}

  draw() {
    for (const plot of this.plots) plot.destroy();
    this.plots = [];
    this.root.replaceChildren();
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim();
    const look = { ink: colour("--soft"), faint: colour("--line"), accent: colour("--accent"), second: colour("--second") };
    const padding = parseFloat(getComputedStyle(this.root).paddingLeft) || 18;
    const width = Math.max(220, Math.floor(this.root.parentElement!.clientWidth - 2 * padding));
    const lines = convergence(this.data, width, look);
    if (lines && this.data.history) {
      const { iteration, gradient, deviation } = this.data.history;
      const positive = (list: number[]) => list.map((x) => (x > 0 ? x : null));
      this.add("Convergence", lines, [iteration, positive(gradient), positive(deviation)]);
    }
    const [centres, counts] = histogram(this.data);
    const paths = uPlot.paths.bars!({ size: [0.92, 100], align: 0 });
    const unit = this.data.unit ? ` [${this.data.unit}]` : "";
    this.add(
      "Samples by deviation",
      {
        width,
        height: 160,
        legend: { show: false },
        cursor: { show: false },
        scales: { x: { time: false, range: [0, this.data.maximum || 1] }, y: { range: (_, __, max) => [0, Math.max(1, max * 1.06)] } },
        axes: [axis(look, { label: "deviation" + unit, labelSize: 18, size: 34, values: (_, ticks) => ticks.map(short) }), axis(look, { size: 52 })],
        series: [
          {},
          {
            paths,
            points: { show: false },
            fill: (u) => {
              const gradient = u.ctx.createLinearGradient(u.bbox.left, 0, u.bbox.left + u.bbox.width, 0);
              for (let k = 0; k <= 8; ++k) gradient.addColorStop(k / 8, css(deviationColour((k / 8) * this.data.maximum, this.data.maximum, this.data.tolerance)));
              return gradient;
            },
          },
        ],
      },
      [centres, counts],
    );
  }

  private add(name: string, options: uPlot.Options, values: uPlot.AlignedData) {
    const heading = document.createElement("h2");
    heading.textContent = name;
    const place = document.createElement("div");
    this.root.append(heading, place);
    this.plots.push(new uPlot(options, values, place));
  }
}
