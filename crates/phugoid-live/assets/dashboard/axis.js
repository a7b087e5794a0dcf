// Scales: round steps, labels that cannot touch each other, ranges that do not tremble.
"use strict";

// Round values (1, 2 or 5 times a power of ten) between two numbers, at most `most` of them.
function ticks(low, high, most) {
  const rough = (high - low) / Math.max(most, 1);
  if (!(rough > 0) || !Number.isFinite(rough)) return { step: 1, values: [] };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough * (1 - 1e-9)) || 10 * power;
  const values = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step && values.length <= most + 1; k += 1) {
    values.push(k * step);
  }
  return { step, values };
}

// Decimals that tell multiples of a step apart.
function decimalsOf(step) {
  return Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
}

// Power of ten to take out of an axis, so that its labels stay short: 0 where they are short as they are.
function axisPower(low, high, step) {
  const size = Math.max(Math.abs(low), Math.abs(high));
  if (size >= 1e5 || decimalsOf(step) > 4) return 3 * Math.floor(Math.log10(size || 1) / 3);
  return 0;
}

// A range that grows at once when the data leave it and shrinks only when they fill less than half of it, so that the
// scale does not tremble while data arrive.
class Range {
  constructor() { this.low = NaN; this.high = NaN; }

  fit(low, high, least) {
    if (!(high >= low)) return;
    let span = high - low;
    if (span < least) {
      low -= (least - span) / 2;
      high += (least - span) / 2;
      span = least;
    }
    const have = this.high - this.low;
    if (!(have > 0) || low < this.low || high > this.high || span < 0.5 * have) {
      this.low = low - 0.08 * span;
      this.high = high + 0.08 * span;
    }
  }

  // Forgets, so that the next fit is exact.
  forget() { this.low = NaN; this.high = NaN; }
}
