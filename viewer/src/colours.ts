// Colours of deviation and curvature, readable on light and dark grounds.

type Colour = [number, number, number];

const sequence: Colour[] = [
  [0.2, 0.36, 0.72],
  [0.16, 0.6, 0.72],
  [0.36, 0.74, 0.45],
  [0.93, 0.79, 0.27],
  [0.93, 0.5, 0.2],
];
const diverging: Colour[] = [
  [0.16, 0.38, 0.75],
  [0.55, 0.72, 0.88],
  [0.93, 0.93, 0.92],
  [0.95, 0.68, 0.48],
  [0.76, 0.22, 0.18],
];
/** Beyond the tolerance. */
export const over: Colour = [0.82, 0.1, 0.42];

function along(stops: Colour[], part: number): Colour {
  const place = Math.min(Math.max(part, 0), 1) * (stops.length - 1);
  const k = Math.min(Math.floor(place), stops.length - 2);
  const f = place - k;
  return [0, 1, 2].map((d) => stops[k][d] * (1 - f) + stops[k + 1][d] * f) as Colour;
}

/** Colour of a deviation: along the scale up to `top`, apart beyond the tolerance. */
export function deviationColour(value: number, top: number, tolerance: number): Colour {
  if (tolerance > 0 && value > tolerance * (1 + 1e-6)) return over;
  return along(sequence, top > 0 ? value / top : 0);
}

/** Colour of a signed value, -1 to 1. */
export const signedColour = (part: number): Colour => along(diverging, (part + 1) / 2);

export const css = (c: Colour) => `rgb(${c.map((x) => Math.round(255 * x)).join(" ")})`;

/** The scale as a gradient from left to right. */
export const sequenceGradient = () => `linear-gradient(to right, ${sequence.map(css).join(", ")})`;
export const divergingGradient = () => `linear-gradient(to right, ${diverging.map(css).join(", ")})`;

/** The colour as light, which is what vertex colours are. */
export const light = (c: Colour): Colour => c.map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4)) as Colour;
