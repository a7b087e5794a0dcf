// Puts the parts together: documents go to the flight as they come; pictures are drawn when the screen asks for one.
"use strict";

const flight = new Flight();
const view = new TimeWindow(flight.store);
const panels = new Panels();
const controls = new Controls(view, panels);
let stream = null;

// What the check of this page reads; nothing else depends on it.
const statistics = { frames: 0, drawn: 0, slowest_ms: 0 };
window.phugoid = { flight, view, controls, panels, statistics };

function rebuild() {
  view.reset(flight.store);
  panels.build(flight);
  controls.change();
  const { hello, layout } = flight;
  const parts = [hello.source, layout.model && `model ${layout.model}`, layout.method && `method ${layout.method}`];
  setText(byId("source"), parts.filter(Boolean).join(", "));
  document.title = hello.source ? `Phugoid: ${hello.source}` : "Phugoid";
  drawnRows = -1;
}

let drawnRows = -1;
let toldRows = -1;
let statusAt = -Infinity;
let valuesAt = -Infinity;

function picture(now) {
  requestAnimationFrame(picture);
  statistics.frames += 1;
  // Words change ten times a second at most: more cannot be read.
  if (now - statusAt > 100) {
    showStatus(flight, stream, view);
    statusAt = now;
  }
  if (flight.eventsChanged) {
    panels.events(flight);
    flight.eventsChanged = false;
  }
  if (flight.linkChanged) {
    showLink(flight);
    flight.linkChanged = false;
  }
  if (!flight.newest) return;
  if (view.store !== flight.store) view.reset(flight.store);
  const rows = flight.store.received;
  const moved = controls.changed || panels.stale || (rows !== drawnRows && !view.paused);
  const untold = now - valuesAt > 100 && toldRows !== rows && !view.paused;
  if (!moved && !untold && !panels.charts.some((chart) => chart.visible && !chart.fresh)) return;
  const began = performance.now();
  const bounds = controls.drag && controls.drag.mode === "mark" ? controls.drag.bounds : view.bounds();
  const state = { cursor: controls.cursor, marked: controls.marked, whole: controls.whole, until: view.latest() };
  for (const chart of panels.charts) {
    if (chart.visible) chart.draw(flight.store, bounds, state); else chart.fresh = false;
  }
  if (now - valuesAt > 100 || controls.changed) {
    if (!view.paused) panels.values(flight.newest);
    panels.signals(flight.store, Number.isFinite(controls.cursor) ? controls.cursor : Math.min(bounds[1], view.latest()));
    valuesAt = now;
    toldRows = rows;
  }
  drawnRows = rows;
  controls.changed = false;
  panels.stale = false;
  statistics.drawn += 1;
  statistics.slowest_ms = Math.max(statistics.slowest_ms, performance.now() - began);
}

function start() {
  readColours();
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    controls.changed = true;
  });
  window.addEventListener("error", (event) => { flight.trouble = `this page failed: ${event.message}`; });
  const data = byId("data");
  if (data) {
    controls.usual = Infinity;
    view.span = Infinity;
    const result = JSON.parse(data.textContent);
    flight.load(result);
    rebuild();
    for (const id of ["pause", "follow"]) byId(id).hidden = true;
    byId("link-section").hidden = !flight.link;
    const sentences = [...result.verdict];
    if (flight.thinned) {
      sentences.push(`Charts show the least and the greatest value of every ${count(flight.thinned)} samples.`);
    }
    if (result.status === "refused" || result.status === "doubtful") {
      byId("alarm").textContent = sentences[0];
      byId("alarm").className = result.status;
      byId("alarm").hidden = false;
    }
    byId("verdict").hidden = sentences.length === 0;
    byId("verdict").querySelector("ul").append(...sentences.map((s) => element("li", "", s)));
  } else {
    stream = new Stream((document) => { if (flight.take(document)) rebuild(); },
      (what) => { flight.trouble = what; });
    window.phugoid.stream = stream;
    stream.open("events");
  }
  requestAnimationFrame(picture);
}

start();
