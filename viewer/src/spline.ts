// B-splines of one to three axes: values and derivatives over grids of parameters.
import type { SplineData } from "./data";

/** Index of the knot span that holds t. */
function spanOf(degree: number, knots: number[], t: number): number {
  let low = degree;
  let high = knots.length - degree - 1;
  if (t >= knots[high]) {
    while (knots[high - 1] >= knots[high]) --high;
    return high - 1;
  }
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t < knots[middle]) high = middle;
    else low = middle;
  }
  return low;
}

/** Values of the degree + 1 B-splines on a span, or of their derivative of the given order. */
function basis(degree: number, knots: number[], span: number, t: number, order: number): Float64Array {
  const values = new Float64Array(degree + 1);
  if (order > degree) return values;
  const lower = degree - order;
  values[0] = 1;
  for (let p = 1; p <= lower; ++p) {
    let carried = 0;
    for (let r = 0; r < p; ++r) {
      const left = knots[span + 1 - p + r];
      const right = knots[span + 1 + r];
      const part = right > left ? values[r] / (right - left) : 0;
      values[r] = carried + (right - t) * part;
      carried = (t - left) * part;
    }
    values[p] = carried;
  }
  for (let p = lower + 1; p <= degree; ++p) {
    let carried = 0;
    for (let r = 0; r < p; ++r) {
      const left = knots[span + 1 - p + r];
      const right = knots[span + 1 + r];
      const part = right > left ? (p * values[r]) / (right - left) : 0;
      values[r] = carried - part;
      carried = part;
    }
    values[p] = carried;
  }
  return values;
}

/** The parameters of an axis's breakpoints with `pieces` equal steps between neighbours. */
export function places(spline: SplineData, axis: number, pieces: number): number[] {
  const p = spline.degree[axis];
  const inside = spline.knots[axis].slice(p, spline.knots[axis].length - p);
  const breaks = inside.filter((t, i) => i === 0 || t > inside[i - 1]);
  const result = [breaks[0]];
  for (let b = 0; b + 1 < breaks.length; ++b)
    for (let k = 1; k <= pieces; ++k) result.push(breaks[b] + ((breaks[b + 1] - breaks[b]) * k) / pieces);
  return result;
}

/** Steps per span so that an axis has about `wanted` places, at least two. */
export function piecesFor(spline: SplineData, axis: number, wanted: number): number {
  const p = spline.degree[axis];
  const spans = Math.max(1, spline.shape[axis] - p);
  return Math.max(2, Math.min(24, Math.round(wanted / spans)));
}

/** Points (or derivatives of the given orders) over the grid of parameters, last axis fastest. */
export function evaluate(spline: SplineData, parameters: number[][], orders: number[], control = spline.control): Float64Array {
  const dim = spline.dim;
  const shape = [...spline.shape];
  let values: Float64Array = Float64Array.from(control);
  for (let axis = 0; axis < shape.length; ++axis) {
    const p = spline.degree[axis];
    const t = parameters[axis];
    const n = shape[axis];
    const outer = shape.slice(0, axis).reduce((a, b) => a * b, 1);
    const inner = shape.slice(axis + 1).reduce((a, b) => a * b, 1) * dim;
    const next = new Float64Array(outer * t.length * inner);
    for (let j = 0; j < t.length; ++j) {
      const span = spanOf(p, spline.knots[axis], t[j]);
      const b = basis(p, spline.knots[axis], span, t[j], orders[axis]);
      for (let o = 0; o < outer; ++o)
        for (let r = 0; r <= p; ++r) {
          const from = (o * n + span - p + r) * inner;
          const to = (o * t.length + j) * inner;
          for (let c = 0; c < inner; ++c) next[to + c] += b[r] * values[from + c];
        }
    }
    values = next;
    shape[axis] = t.length;
  }
  return values;
}
