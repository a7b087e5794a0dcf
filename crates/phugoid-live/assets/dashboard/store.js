// What has been received, in memory that does not grow: ring buffers of fixed size, one of single samples and coarser
// ones above it that keep the least and the greatest value of each group, so that no peak is lost by drawing few points.
"use strict";

const GROUP = 4;

class Ring {
  constructor(columns, capacity, pairs) {
    this.capacity = capacity;
    this.time = new Float64Array(capacity);
    const arrays = () => Array.from({ length: columns }, () => new Float32Array(capacity));
    this.low = arrays();
    this.high = pairs ? arrays() : this.low;
    this.next = 0;
    this.size = 0;
  }

  // Place in the arrays of the i-th oldest row.
  at(i) {
    const place = this.next - this.size + i;
    return place < 0 ? place + this.capacity : place;
  }

  advance() {
    this.next = (this.next + 1) % this.capacity;
    if (this.size < this.capacity) this.size += 1;
  }

  // How many rows are older than `time`.
  before(time) {
    let low = 0, high = this.size;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[this.at(middle)] < time) low = middle + 1; else high = middle;
    }
    return low;
  }

  oldest() { return this.size ? this.time[this.at(0)] : Infinity; }
}

// The group that is being filled.
class Group {
  constructor(columns) {
    this.low = new Float32Array(columns);
    this.high = new Float32Array(columns);
    this.time = NaN;
    this.rows = 0;
  }
}

class Store {
  // `rows`: room for single samples; without it 5 minutes at 100 Hz, 11 hours in the coarsest, in some 47 MB at 60 columns.
  constructor(columns, rows) {
    this.columns = columns;
    const most = rows || Math.max(4096, Math.min(32768, Math.floor(2 ** 22 / Math.max(columns, 1))));
    this.rings = [0, 1, 2, 3, 4].map((level) => new Ring(columns, level < 2 ? most : most >> 1, level > 0));
    this.groups = [1, 2, 3, 4].map(() => new Group(columns));
    this.first = NaN;
    this.last = NaN;
    this.received = 0;
  }

  // Appends a row; false where its time is not after the last one.
  push(time, row) {
    if (!(time > this.last) && this.received > 0) return false;
    const ring = this.rings[0];
    ring.time[ring.next] = time;
    for (let c = 0; c < this.columns; c += 1) ring.low[c][ring.next] = row[c];
    ring.advance();
    if (this.received === 0) this.first = time;
    this.last = time;
    this.received += 1;
    this.lift(0, time, row, row);
    return true;
  }

  // Takes a row of one level into the group above it, and the group into its ring when it is full.
  lift(level, time, low, high) {
    const group = this.groups[level];
    if (!group) return;
    for (let c = 0; c < this.columns; c += 1) {
      if (group.rows === 0) {
        group.low[c] = low[c];
        group.high[c] = high[c];
      } else {
        if (!(group.low[c] <= low[c]) && low[c] === low[c]) group.low[c] = low[c];
        if (!(group.high[c] >= high[c]) && high[c] === high[c]) group.high[c] = high[c];
      }
    }
    if (group.rows === 0) group.time = time;
    group.rows += 1;
    if (group.rows < GROUP) return;
    const ring = this.rings[level + 1];
    ring.time[ring.next] = group.time;
    for (let c = 0; c < this.columns; c += 1) {
      ring.low[c][ring.next] = group.low[c];
      ring.high[c][ring.next] = group.high[c];
    }
    ring.advance();
    group.rows = 0;
    this.lift(level + 1, group.time, group.low, group.high);
  }

  // The finest level that reaches back to `from` and has at most `most` rows in the window, and which of its rows: one
  // more at either end, so that lines run out of the picture. What lies after its last row is in finer levels.
  window(from, to, most) {
    let chosen = null;
    for (let level = 0; level < this.rings.length; level += 1) {
      const ring = this.rings[level];
      if (ring.size === 0) break;
      const begin = Math.max(0, ring.before(from) - 1);
      const end = Math.min(ring.size, ring.before(to) + 1);
      chosen = { level, ring, begin, end };
      const reaches = ring.oldest() <= from || ring.oldest() <= this.first;
      if (reaches && end - begin <= most) break;
    }
    return chosen;
  }

  // Calls visit(time, low, high) for a column over a window: the rows chosen, then the newest ones, which are still in
  // groups that are being filled, from the finer levels.
  each(chosen, column, to, visit) {
    if (!chosen) return;
    let { level, ring, begin, end } = chosen;
    for (;;) {
      const time = ring.time, low = ring.low[column], high = ring.high[column];
      for (let i = begin; i < end; i += 1) {
        const place = ring.at(i);
        visit(time[place], low[place], high[place]);
      }
      if (level === 0 || end < ring.size) return;
      level -= 1;
      ring = this.rings[level];
      begin = ring.size - this.groups[level].rows;
      end = Math.max(begin, Math.min(ring.size, ring.before(to) + 1));
    }
  }

  // The last value of a column that is not after `time` and at most a second before it: a signal that comes less often
  // than the others is missing in most rows. NaN where there is none.
  valueAt(column, time) {
    const ring = this.rings[0];
    for (let i = ring.before(time + 1e-9) - 1; i >= 0; i -= 1) {
      const place = ring.at(i), value = ring.low[column][place];
      if (value === value) return value;
      if (ring.time[place] < time - 1) break;
    }
    return NaN;
  }
}
