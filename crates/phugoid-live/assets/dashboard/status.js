// The state of the page in a symbol and words.
"use strict";

const SYMBOLS = { live: "●", waiting: "◌", paused: "‖", stale: "△", error: "✕", ended: "■" };

// Kind, words, and a sentence where something has to be known.
function statusOf(flight, stream, view) {
  const time = timeText(flight.store.last);
  if (!stream) return { kind: "ended", words: "Result", notice: "" };
  if (flight.ended) {
    return { kind: "ended", words: `Ended at ${time}`, notice: `The stream has ended: ${flight.ended.reason}. What came in stays on this page.` };
  }
  if (stream.state === "broken") {
    const since = (performance.now() - stream.brokenAt) / 1000;
    return {
      kind: "error", words: "Connection lost", bad: true,
      notice: `The connection to phugoid has been lost for ${timeText(since, 0)}; trying again. What is shown ends at ${time}.`,
    };
  }
  if (stream.state === "connecting") return { kind: "waiting", words: "Connecting" };
  if (!flight.newest) return { kind: "waiting", words: "Waiting" };
  if (stream.isStale()) {
    const sender = flight.silent ? "The sender is silent" : "No new estimates";
    return { kind: "stale", words: "Old data", notice: `${sender} for ${timeText(stream.age(), 0)}. What is shown ends at ${time}.` };
  }
  if (view.paused) {
    return { kind: "paused", words: `Paused at ${timeText(view.until)}; ${timeText(flight.store.last - view.until)} behind` };
  }
  const doubt = flight.newest.change === "in_doubt";
  return { kind: "live", words: `Live ${time}`, notice: doubt ? "A change of the aircraft is suspected: bounds are widened until it is decided." : "" };
}

// What stands in place of the charts before the first estimate.
function waitingWords(flight, stream) {
  if (stream.state === "broken") {
    return { words: "No connection", note: "phugoid does not answer at this address. This page goes on trying; is `phugoid live` still running?" };
  }
  if (stream.state === "connecting") return { words: "Connecting to phugoid" };
  if (flight.waiting) {
    return {
      words: "Preparing the estimation", note: sentence(flight.waiting) +
        " The first samples tell the noise of the sensors and the reference flight condition; estimates begin after them.",
    };
  }
  const from = flight.hello && flight.hello.source ? ` from ${flight.hello.source}` : "";
  const got = flight.link && flight.link.received > 0 ? ` ${count(flight.link.received)} messages received so far.` : "";
  return flight.ended
    ? { words: "The stream ended before the first estimate", note: sentence(flight.ended.reason) }
    : { words: "Waiting for measurements", note: `Connected; nothing to estimate${from} yet.${got}` };
}

function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1).replace(/\.?$/, ".");
}

function showStatus(flight, stream, view) {
  const status = statusOf(flight, stream, view);
  if (flight.trouble) {
    status.notice = [status.notice, `Error: ${flight.trouble}.`].filter(Boolean).join(" ");
    status.bad = true;
  }
  const node = byId("status");
  if (node.className !== status.kind) node.className = status.kind;
  setText(node.querySelector(".symbol"), SYMBOLS[status.kind]);
  setText(node.querySelector(".words"), status.words);
  const notice = byId("notice");
  setText(notice, status.notice || "");
  notice.hidden = !status.notice;
  notice.classList.toggle("bad", Boolean(status.bad));
  byId("panels").classList.toggle("old", status.kind === "stale" || status.kind === "error");
  const empty = !flight.newest;
  byId("panels").hidden = empty;
  byId("waiting").hidden = !empty;
  if (!empty || !stream) return;
  const { words: text, note } = waitingWords(flight, stream);
  setText(byId("waiting-words"), text);
  setText(byId("waiting-note"), note || "");
}
