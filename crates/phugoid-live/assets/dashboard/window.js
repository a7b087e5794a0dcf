// The part of time that all charts show together.
"use strict";

const SHORTEST_S = 0.2;

class TimeWindow {
  constructor(store) {
    this.span = 60;
    this.reset(store);
  }

  // `store` may be replaced when another stream begins.
  reset(store) {
    this.store = store;
    this.following = true;
    this.paused = false;
    this.end = NaN;
    this.until = NaN;
  }

  // The newest time that is shown: that of the pause, if there is one.
  latest() { return this.paused ? this.until : this.store.last; }

  bounds() {
    const first = this.store.first, latest = this.latest();
    if (!Number.isFinite(first)) return [0, 1];
    const end = this.following ? latest : this.end;
    let begin = this.span === Infinity ? first : end - this.span;
    // While there is less than the span, the charts fill up from the left end of what there is.
    if (this.following && begin < first) begin = first;
    return [begin, Math.max(end, begin + SHORTEST_S)];
  }

  pause(yes) {
    if (yes && !this.paused) this.until = this.store.last;
    this.paused = yes;
  }

  follow() {
    this.following = true;
    this.paused = false;
  }

  show(span) {
    const [begin, end] = this.bounds();
    this.span = span;
    if (span === Infinity) this.following = true;
    if (!this.following) this.place((begin + end) / 2 - span / 2, (begin + end) / 2 + span / 2);
  }

  // Shows exactly this part, within what there is.
  place(begin, end) {
    const first = this.store.first, latest = this.latest();
    if (!Number.isFinite(first)) return;
    const whole = Math.max(latest - first, SHORTEST_S);
    const span = Math.min(Math.max(end - begin, SHORTEST_S), whole);
    const last = Math.min(Math.max(begin + span, first + span), Math.max(latest, first + span));
    this.span = span;
    this.end = last;
    this.following = false;
  }

  move(seconds) {
    const [begin, end] = this.bounds();
    this.place(begin + seconds, end + seconds);
  }

  // Shortens (factor below one) or lengthens the window about a time; while following, about the newest time.
  zoom(factor, about) {
    const [begin, end] = this.bounds();
    if (this.following && (about === undefined || about > end - 0.02 * (end - begin))) {
      const whole = this.latest() - this.store.first;
      const span = (end - begin) * factor;
      this.span = span >= whole && factor > 1 ? Math.max(span, 10) : Math.max(span, SHORTEST_S);
      return;
    }
    const centre = about === undefined ? (begin + end) / 2 : about;
    this.place(centre - (centre - begin) * factor, centre + (end - centre) * factor);
  }
}
