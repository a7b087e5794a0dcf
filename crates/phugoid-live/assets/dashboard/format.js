// Numbers and units as people read them.
"use strict";

const DEGREES = 180 / Math.PI;

// The unit in which an SI quantity is shown, and the factor to it: angles in degrees, as in the reports.
function humanUnit(si) {
  const unit = (si || "").trim();
  switch (unit) {
    case "": case "-": case "1": return { text: "", factor: 1 };
    case "rad": return { text: "deg", factor: DEGREES };
    case "rad/s": return { text: "deg/s", factor: DEGREES };
    case "rad/s^2": return { text: "deg/s²", factor: DEGREES };
    default: return { text: raised(unit).replace(/\*/g, "·"), factor: 1 };
  }
}

// `1/rad` as `per rad`, `rad` of a sensor's bias in degrees; derivatives stay per radian, as everywhere in Phugoid.
function parameterUnit(si) {
  const unit = (si || "").trim();
  if (unit.startsWith("1/")) return { text: "per " + raised(unit.slice(2)), factor: 1 };
  return humanUnit(unit);
}

function superscript(number) {
  return [...String(number)].map((c) => (c === "-" ? "⁻" : "⁰¹²³⁴⁵⁶⁷⁸⁹"[c])).join("");
}

function raised(unit) {
  return unit.replace(/\^(-?\d)/g, (_, power) => superscript(power));
}

// A number with so many significant digits and a true minus sign; powers of ten where zeros would pile up.
function significant(value, digits) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent < -4 || exponent > 6) return minus(value.toExponential(digits - 1));
  return minus(value.toFixed(Math.max(0, digits - 1 - exponent)));
}

function minus(text) {
  return text.replace(/^-/, "−").replace(/e\+?(-?\d+)$/, (_, power) => " × 10" + superscript(power));
}

// A value and its bound to the digits that the bound leaves: two of the bound, and as many decimals for the value.
function valueWithBound(value, bound) {
  if (!Number.isFinite(value)) return "–";
  if (!Number.isFinite(bound) || bound <= 0) return significant(value, 5);
  const exponent = Math.floor(Math.log10(bound));
  const decimals = Math.max(0, 1 - exponent);
  if (decimals > 6 || exponent > 6) return `${significant(value, 4)} ± ${significant(bound, 2)}`;
  return `${minus(value.toFixed(decimals))} ± ${bound.toFixed(decimals)}`;
}

function timeText(seconds, decimals = 1) {
  if (!Number.isFinite(seconds)) return "–";
  return minus(seconds.toFixed(decimals)) + " s";
}

function count(number) {
  return Number.isFinite(number) ? Math.round(number).toString().replace(/\B(?=(\d{3})+$)/g, " ") : "–";
}

function bytesText(bytes) {
  if (!Number.isFinite(bytes)) return "–";
  if (bytes < 1e4) return count(bytes) + " bytes";
  return bytes < 1e6 ? (bytes / 1e3).toFixed(0) + " kB" : (bytes / 1e6).toFixed(1) + " MB";
}

function words(name) {
  return String(name).replace(/_/g, " ");
}

// Symbol, words and class of what is known about a parameter. Never the colour alone: the symbol and the words say it.
const VERDICTS = {
  converged: ["✓", "converged", "good"],
  ready: ["✓", "ready", "good"],
  improving: ["↗", "improving", "wait"],
  not_excited: ["○", "not excited", "none"],
  not_identifiable: ["⊘", "needs another input", "none"],
  unknown: ["?", "unknown since a change", "bad"],
  at_limit: ["⊣", "at the limit of the model file", "limit"],
  in_doubt: ["?", "in doubt: the model contradicts the flight", "bad"],
  doubtful: ["?", "doubtful", "bad"],
  fixed: ["■", "fixed", "none"],
};

function verdictOf(status, verdict) {
  const [symbol, text, kind] = VERDICTS[status] || VERDICTS[verdict] || ["·", words(status || verdict || ""), "none"];
  const more = verdict && verdict !== status && VERDICTS[verdict] && !(status === "converged" && verdict === "ready")
    ? VERDICTS[verdict] : null;
  if (!more || more[1] === text) return { symbol, text, kind };
  // Two judgements: the worse one gives symbol and colour, both give words.
  const rank = { good: 0, wait: 1, none: 2, limit: 3, bad: 4 };
  return rank[more[2]] > rank[kind]
    ? { symbol: more[0], text: `${text}, ${more[1]}`, kind: more[2] }
    : { symbol, text: `${text}, ${more[1]}`, kind };
}
