// The link in words: what was received, what was lost, how late it came.
"use strict";

// Fields of the document `link`: words, how a value is told, and from which value on it stands out.
const LINK_ROWS = {
  received: ["received", count],
  samples: ["samples used", count],
  lost: ["lost", count, 1],
  late: ["late, left out", count, 1],
  duplicated: ["received twice", count],
  reordered: ["out of order", count],
  checksum_failures: ["wrong checksum", count, 1],
  garbage_bytes: ["bytes of nothing", count, 1],
  refused: ["refused", count, 1],
  leaps: ["leaps of the time, left out", count, 1],
  strangers: ["of others, not used", count, 1],
  unverified: ["not signed, left out", count, 1],
  restarts: ["restarts of the sender", count, 1],
  stalled: ["stalls of its clock", count, 1],
  recorded_bytes: ["recorded", bytesText],
};

function linkRows(link, silent) {
  const rows = [];
  const add = (name, text, far = false) => rows.push({ name, text, far });
  add("sender", silent ? "⚠ nothing comes in" : "sending", silent);
  for (const [key, [name, tell, far]] of Object.entries(LINK_ROWS)) {
    if (typeof link[key] !== "number") continue;
    const many = far !== undefined && link[key] >= far;
    const share = key === "lost" && link.received > 0 && link.lost > 0
      ? ` (${significant((100 * link.lost) / (link.received + link.lost), 2)} %)` : "";
    add(name, (many ? "⚠ " : "") + tell(link[key]) + share, many);
  }
  for (const [key, value] of Object.entries(link.latency_ms || {})) {
    if (typeof value === "number") add(`latency ${quantileName(key)}`, `${significant(value, 3)} ms`);
  }
  return rows;
}

// `p50`, `p99_9` or `p99.9` in words.
function quantileName(key) {
  const match = /^p(\d+)(?:[._](\d+))?$/.exec(key);
  if (!match) return key === "max" ? "(largest)" : words(key);
  return match[1] === "50" && !match[2] ? "(median)" : `(${match[1]}${match[2] ? "." + match[2] : ""} % below)`;
}

function showLink({ link, silent }) {
  const rows = link ? linkRows(link, silent) : [];
  byId("link").replaceChildren(...rows.flatMap(({ name, text, far }) => [
    element("dt", "", name), element("dd", far ? "far" : "", text)]));
  byId("no-link").hidden = rows.length > 0;
}
