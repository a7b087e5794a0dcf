// The link in words: what was received, what was lost, how late it came.
"use strict";

// Fields of the document `link`: words, how a value is told, and from which value on it stands out.
const LINK_ROWS = {
  received: ["received", count],
  lost: ["lost", count, 1],
  late: ["late", count, 1],
  duplicated: ["received twice", count],
  reordered: ["out of order", count],
  damaged: ["damaged", count, 1],
  refused: ["refused", count, 1],
  restarts: ["restarts of the sender", count, 1],
  recorded_bytes: ["recorded", bytesText],
  recorded_to: ["recorded to", String],
};

function linkRows(link) {
  const rows = [];
  const add = (name, text, far = false) => rows.push({ name, text, far });
  if ("stalled" in link) add("sender", link.stalled ? "⚠ nothing comes in" : "sending", Boolean(link.stalled));
  for (const [key, [name, tell, far]] of Object.entries(LINK_ROWS)) {
    if (link[key] === undefined || link[key] === null) continue;
    const many = typeof far === "number" && link[key] >= far;
    const share = key === "lost" && link.received > 0 && link.lost > 0
      ? ` (${significant((100 * link.lost) / (link.received + link.lost), 2)} %)` : "";
    add(name, (many ? "⚠ " : "") + tell(link[key]) + share, many);
  }
  const latency = link.latency_ms;
  if (latency && typeof latency === "object") {
    for (const [key, value] of Object.entries(latency)) {
      if (typeof value === "number") add(`latency ${quantileName(key)}`, `${significant(value, 3)} ms`);
    }
  }
  return rows;
}

// `p50`, `p99_9` or `p99.9` in words.
function quantileName(key) {
  const match = /^p(\d+)(?:[._](\d+))?$/.exec(key);
  if (!match) return words(key);
  return match[1] === "50" && !match[2] ? "(median)" : `(${match[1]}${match[2] ? "." + match[2] : ""} % below)`;
}

function showLink(link) {
  const rows = link ? linkRows(link) : [];
  byId("link").replaceChildren(...rows.flatMap(({ name, text, far }) => [
    element("dt", "", name), element("dd", far ? "far" : "", text)]));
  byId("no-link").hidden = rows.length > 0;
}
