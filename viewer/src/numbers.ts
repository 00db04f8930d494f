/** A number as the report writes it: six digits, no trailing zeros. */
export function digits(x: number, count = 6): string {
  if (!Number.isFinite(x)) return "-";
  return String(Number(x.toPrecision(count)));
}
