// The page's panels: cards with charts, events, link.
"use strict";

const byId = (id) => document.getElementById(id);

function element(tag, className, text) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  if (text !== undefined) made.textContent = text;
  return made;
}

// Sets a text only where it differs: most of them stay the same from one picture to the next.
function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

class Panels {
  constructor() {
    this.charts = [];
    this.cards = [];
    this.sizes = new ResizeObserver((entries) => {
      for (const { target, contentRect } of entries) target.chart.resize(contentRect.width, contentRect.height);
      this.stale = true;
    });
    // A chart that is out of sight is not drawn.
    this.sight = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) target.chart.visible = isIntersecting;
      this.stale = true;
    }, { rootMargin: "100px" });
  }

  // Makes the cards for a layout.
  build(flight) {
    const { layout, places } = flight;
    for (const chart of this.charts) {
      this.sizes.unobserve(chart.canvas);
      this.sight.unobserve(chart.canvas);
    }
    this.charts = [];
    for (const id of ["parameters", "nuisance", "inputs", "outputs", "residuals"]) byId(id).replaceChildren();
    this.cards = layout.parameters.map((p, i) => this.parameter(p, places.parameters + 3 * i));
    const unitOf = (signal) => humanUnit(signal.unit);
    this.readings = [];
    // Signals have lines of one pixel, which browsers draw in half the time of wider ones.
    layout.inputs.forEach((input, i) => {
      const column = places.inputs + i;
      this.signal("inputs", input.name, unitOf(input), [{ column, colour: "blue", width: 1 }]);
    });
    layout.outputs.forEach((output, i) => {
      const column = places.outputs + 3 * i;
      this.signal("outputs", output.name, unitOf(output), [
        { column, colour: "muted", width: 1 }, { column: column + 1, colour: "orange", width: 1 }]);
      this.signal("residuals", output.name, { text: "σ", factor: 1 },
        [{ column: column + 2, colour: "blue", width: 1 }], { marks: [-4, -2, 2, 4] });
    });
    byId("nuisance-part").hidden = !layout.parameters.some((p) => p.nuisance);
    byId("inputs-section").hidden = layout.inputs.length === 0;
    byId("parameters-section").querySelector(".truth-key").hidden = !layout.parameters.some((p) => Number.isFinite(p.truth));
  }

  parameter(layout, column) {
    const unit = parameterUnit(layout.unit);
    const card = this.card(layout.nuisance ? "nuisance" : "parameters", layout.name, unit, {
      lines: [{ column, colour: "blue", width: 1.6 }], band: [column + 1, column + 2], settled: true, truth: layout.truth,
    });
    card.name = layout.name;
    card.nuisance = layout.nuisance;
    card.verdict = card.head.appendChild(element("span", "verdict"));
    card.symbol = card.verdict.appendChild(element("span", "symbol"));
    card.words = card.verdict.appendChild(element("span"));
    card.parts = card.head.appendChild(element("div", "parts"));
    card.parts.hidden = true;
    card.random = card.parts.appendChild(element("div", "track")).appendChild(element("div", "random"));
    card.partWords = card.parts.appendChild(element("span"));
    return card;
  }

  signal(place, name, unit, lines, more) {
    const card = this.card(place, words(name), unit, { lines, ...more });
    this.readings.push({ ...card, lines, unit });
  }

  card(place, name, unit, options) {
    const root = element("div", "card");
    const head = root.appendChild(element("div", "head"));
    head.appendChild(element("span", "name", name));
    const value = head.appendChild(element("span", "value"));
    const number = value.appendChild(element("span", "number"));
    value.append(" ", element("span", "unit", unit.text));
    const canvas = root.appendChild(element("canvas"));
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${name}${unit.text ? " in " + unit.text : ""} against time in seconds`);
    const chart = new Chart({ canvas, unit, ...options });
    canvas.chart = chart;
    this.charts.push(chart);
    this.sizes.observe(canvas);
    this.sight.observe(canvas);
    byId(place).append(root);
    return { root, head, number, chart, unit };
  }

  // Values and verdicts of a snapshot, and how many of each.
  values(snapshot) {
    const totals = new Map();
    snapshot.parameters.forEach((p, i) => {
      const card = this.cards[i];
      if (!card) return;
      const factor = card.unit.factor, fixed = p.status === "fixed";
      const sigma = typeof p.std_error === "number" ? p.std_error : NaN;
      setText(card.number, p.value === null ? "–" : valueWithBound(p.value * factor, fixed ? NaN : 2 * sigma * factor));
      this.parts(card, fixed ? NaN : sigma, p.systematic_std);
      const { symbol, text, kind } = verdictOf(p.status, p.readiness && p.readiness.verdict);
      setText(card.symbol, symbol);
      setText(card.words, text);
      card.verdict.className = "verdict v-" + kind;
      if (card.nuisance) return;
      const name = (VERDICTS[p.status] || [0, words(p.status || "")])[1];
      totals.set(name, (totals.get(name) || 0) + 1);
    });
    const told = [...totals].sort((a, b) => b[1] - a[1]).map(([name, n]) => `${n} ${name}`);
    const all = this.cards.filter((card) => !card.nuisance).length;
    setText(byId("summary"), snapshot.moved === false
      ? `At ${timeText(snapshot.time_s)} nothing has moved yet: the ${all} parameters are what was known beforehand.`
      : `${all} parameters at ${timeText(snapshot.time_s)}: ${told.join(", ")}.`);
    this.notReady(snapshot);
  }

  // The bound in what a longer flight makes smaller (inner bar) and what only a calibration does (the rest of it).
  parts(card, sigma, systematic) {
    const known = sigma > 0 && systematic > 0 && systematic <= sigma;
    if (card.parts.hidden === known) card.parts.hidden = !known;
    if (!known) return;
    const random = Math.sqrt(Math.max(sigma * sigma - systematic * systematic, 0));
    const width = `${(100 * random / sigma).toFixed(0)}%`;
    if (card.random.style.width !== width) card.random.style.width = width;
    const shown = (value) => significant(2 * value * card.unit.factor, 2);
    setText(card.partWords, `random ±${shown(random)}, systematic ±${shown(systematic)}`);
  }

  // Why parameters are not ready, and what would help.
  notReady(snapshot) {
    const lines = [];
    snapshot.parameters.forEach((p, i) => {
      const card = this.cards[i], readiness = p.readiness;
      if (!card || card.nuisance || !readiness || readiness.verdict === "ready") return;
      const advice = readiness.advice ? ` What would help: ${readiness.advice}.` : "";
      lines.push(`${card.name}: ${words(readiness.verdict)}, ${readiness.reason}.${advice}`);
    });
    const list = byId("not-ready").querySelector("ul");
    byId("not-ready").hidden = lines.length === 0;
    setText(byId("not-ready").querySelector("summary"),
      `${lines.length} ${lines.length === 1 ? "parameter is" : "parameters are"} not ready: why, and what would help`);
    if (!byId("not-ready").open && list.childElementCount > 0) return;
    while (list.childElementCount > lines.length) list.lastChild.remove();
    while (list.childElementCount < lines.length) list.append(element("li"));
    lines.forEach((line, i) => setText(list.children[i], line));
  }

  // Values of the signals at a time: where the pointer is, or at the end of the window.
  signals(store, time) {
    for (const { number, lines, unit } of this.readings) {
      setText(number, lines.map((line) => significant(store.valueAt(line.column, time) * unit.factor, 4)).join(" | "));
    }
  }

  events(flight) {
    const shown = flight.events.slice(-200).reverse();
    byId("events").replaceChildren(...shown.map((event) => {
      const item = element("li");
      item.append(element("time", "", typeof event.time_s === "number" ? timeText(event.time_s, 2) : "link"));
      const text = item.appendChild(element("span"));
      text.append(element("span", "kind", words(event.kind)), ": " + event.message);
      return item;
    }));
    const hidden = flight.forgotten + flight.events.length - shown.length;
    if (hidden > 0) byId("events").append(element("li", "note", `and ${count(hidden)} earlier ones`));
    byId("no-events").hidden = shown.length > 0;
    byId("events").hidden = shown.length === 0;
  }
}
