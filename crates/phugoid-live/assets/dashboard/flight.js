// What the documents of a stream tell, gathered: layout, rows for the charts, the newest estimate, events, link, phase.
"use strict";

// Events kept in memory and shown; older ones are counted.
const MOST_EVENTS = 500;

class Flight {
  constructor() {
    this.hello = null;
    this.layout = null;
    this.store = new Store(0);
    this.begin();
  }

  begin() {
    this.newest = null;
    this.readiness = [];
    this.waiting = null;
    this.events = [];
    this.forgotten = 0;
    this.eventsChanged = true;
    this.link = null;
    this.silent = false;
    this.linkChanged = true;
    this.ended = null;
    this.trouble = null;
    this.estimates = 0;
  }

  // Takes one document. True where the layout is another than before, so that charts have to be made anew.
  take(document) {
    switch (document.type) {
      case "hello": return this.greet(document);
      case "estimate": this.estimate(document); break;
      case "event": this.event(document); break;
      case "link":
        // A second without anything received: the sender is silent, not the connection to this page.
        this.silent = Boolean(this.link) && document.received === this.link.received;
        this.link = document;
        this.linkChanged = true;
        this.waiting = document.waiting;
        break;
      case "end": this.ended = document; break;
      default: break; // Later versions may add documents.
    }
    return false;
  }

  greet(hello) {
    const { layout } = hello;
    const shape = JSON.stringify([hello.started, hello.flight, hello.source, layout]);
    this.hello = hello;
    this.ended = null;
    this.greeted = true;
    if (shape === this.shape) return false; // The same stream after a break: what was received stays.
    this.shape = shape;
    this.layout = layout;
    this.places = placesOf(layout);
    this.row = new Float64Array(this.places.columns);
    this.forget();
    return true;
  }

  forget() {
    this.store = new Store(this.places.columns, this.hello.rows);
    this.begin();
  }

  estimate(snapshot) {
    if (!this.layout) return;
    // Readiness is told where it was renewed, and stands until the next.
    snapshot.parameters.forEach((p, i) => {
      if (p.readiness === undefined) p.readiness = this.readiness[i] || null;
      else this.readiness[i] = p.readiness;
    });
    const { row, places } = this;
    const number = (value) => (typeof value === "number" ? value : NaN);
    snapshot.parameters.forEach((p, i) => {
      const place = places.parameters + 3 * i, sigma = number(p.std_error);
      row[place] = number(p.value);
      row[place + 1] = row[place] - 2 * sigma;
      row[place + 2] = row[place] + 2 * sigma;
    });
    places.outputNames.forEach((_, i) => {
      row[places.outputs + 3 * i] = number(snapshot.outputs[i]);
      row[places.outputs + 3 * i + 1] = number(snapshot.predicted[i]);
      row[places.outputs + 3 * i + 2] = number(snapshot.residuals[i]);
    });
    for (let i = 0; i < places.inputCount; i += 1) row[places.inputs + i] = number(snapshot.inputs[i]);
    // Another start of the same source, whose clock has begun anew: a server that goes on begins its past with the
    // first estimate of the flight.
    if (this.greeted && snapshot.time_s < this.store.last && snapshot.time_s !== this.store.first) this.forget();
    this.greeted = false;
    // What was sent again after a break is known already.
    if (!this.store.push(snapshot.time_s, row)) return;
    this.newest = snapshot;
    this.waiting = null;
    this.estimates += 1;
  }

  event(event) {
    const same = (e) => e.time_s === event.time_s && e.kind === event.kind && e.message === event.message;
    if (this.events.slice(-50).some(same)) return;
    this.events.push(event);
    if (this.events.length > MOST_EVENTS) {
      this.events.shift();
      this.forgotten += 1;
    }
    this.eventsChanged = true;
  }

  // A finished result: whole columns at once, in the order of a row.
  load(result) {
    const { time_s: time, columns, samples_per_group: group } = result.history;
    result.parameters.forEach((p, i) => { result.hello.layout.parameters[i].truth = p.truth; });
    this.greet({ ...result.hello, rows: Math.max(time.length, 2) });
    time.forEach((t, k) => {
      columns.forEach((column, c) => { this.row[c] = typeof column[k] === "number" ? column[k] : NaN; });
      this.store.push(t, this.row);
    });
    this.newest = { time_s: this.store.last, parameters: result.parameters };
    result.events.forEach((event) => this.event(event));
    this.link = result.link || null;
    this.thinned = group > 1 ? group : 0;
  }
}

// Where which column stands in a row: three per parameter (value and the edges of its band), three per output (measured,
// predicted, residual), one per input.
function placesOf(layout) {
  const p = layout.parameters.length, r = layout.outputs.length, u = layout.inputs.length;
  return {
    parameters: 0, outputs: 3 * p, inputs: 3 * (p + r), columns: 3 * (p + r) + u,
    outputNames: layout.outputs.map((o) => o.name), inputCount: u,
  };
}
