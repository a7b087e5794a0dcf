// One chart: a canvas with a time axis, a value axis, lines and a band.
"use strict";

const GUTTER = { left: 54, right: 8, top: 20, bottom: 18 };
const FONT = "11px Inter, system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, sans-serif";

// Colours of the style sheet, read again when light and dark change.
const colours = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["panel", "ink", "muted", "grid", "line", "blue", "orange", "vermillion", "band"]) {
    colours[name] = style.getPropertyValue("--" + name).trim();
  }
}

class Chart {
  // `unit`: text at the axis and factor from the store's SI values. `lines`: column, colour, width; `band`:
  // columns of its two edges. `marks`: constant lines. `least`: smallest range shown.
  constructor({ canvas, unit, lines, band, marks, truth, settled, least }) {
    Object.assign(this, { canvas, unit, lines, band, marks, truth, settled });
    this.least = least || 0;
    this.points = new Float32Array(4 * 4096);
    this.context = canvas.getContext("2d");
    this.range = new Range();
    this.width = 0;
    this.height = 0;
    this.visible = true;
    this.fresh = false;
  }

  // Size in CSS pixels from the layout; the backing store is finer on fine displays.
  resize(width, height) {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (width === this.width && height === this.height && ratio === this.ratio) return;
    Object.assign(this, { width, height, ratio });
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.fresh = false;
  }

  plot() {
    return {
      x: GUTTER.left, y: GUTTER.top,
      w: Math.max(20, this.width - GUTTER.left - GUTTER.right),
      h: Math.max(20, this.height - GUTTER.top - GUTTER.bottom),
    };
  }

  timeAt(x) {
    const p = this.plot(), [begin, end] = this.shown || [0, 1];
    return begin + (Math.min(Math.max(x - p.x, 0), p.w) / p.w) * (end - begin);
  }

  // `whole`: parameters show their whole course in place of the settled part.
  draw(store, bounds, { cursor, marked, whole, until }) {
    if (!this.width) return;
    const context = this.context, p = this.plot(), [begin, end] = bounds;
    this.shown = bounds;
    const chosen = store.window(begin, Math.min(end, until), 3 * p.w);
    this.fit(store, chosen, bounds, whole, until);
    const factor = this.unit.factor;
    let { low, high } = this.range;
    if (!(high > low)) { low = -1; high = 1; }
    const x = (t) => p.x + ((t - begin) / (end - begin)) * p.w;
    const y = (v) => p.y + p.h - ((v - low) / (high - low)) * p.h;
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    this.axes(context, p, bounds, low * factor, high * factor);
    context.save();
    context.beginPath();
    context.rect(p.x, p.y, p.w, p.h);
    context.clip();
    const far = { low: low - 4 * (high - low), high: high + 4 * (high - low) };
    const yy = (v) => y(Math.min(Math.max(v, far.low), far.high));
    const draw = { context, store, chosen, bounds, until, x, y: yy };
    if (marked) {
      context.fillStyle = colours.band;
      context.fillRect(x(marked[0]), p.y, x(marked[1]) - x(marked[0]), p.h);
    }
    for (const mark of this.marks || []) this.level(context, p, y(mark), [2, 3], colours.muted);
    if (Number.isFinite(this.truth)) this.level(context, p, y(this.truth), [6, 4], colours.orange);
    if (this.band) this.fill(draw);
    for (const line of this.lines) this.line(draw, line);
    if (cursor >= begin && cursor <= end) {
      context.strokeStyle = colours.muted;
      context.lineWidth = 1;
      context.beginPath();
      context.moveTo(Math.round(x(cursor)) + 0.5, p.y);
      context.lineTo(Math.round(x(cursor)) + 0.5, p.y + p.h);
      context.stroke();
    }
    context.restore();
    this.fresh = true;
  }

  // Range of the values in the window. Of a parameter, unless its whole course is asked for, of the settled part alone:
  // where the bound is at most six times the smallest bound in the window; what lies outside runs out of the picture.
  fit(store, chosen, [begin, end], whole, until) {
    let low = Infinity, high = -Infinity;
    const to = Math.min(end, until);
    const hull = (column) => store.each(chosen, column, to, (t, l, h) => {
      if (t < begin || t > to) return;
      if (l < low) low = l;
      if (h > high) high = h;
    });
    if (this.settled && !whole && this.band) {
      [low, high] = this.settledHull(store, chosen, begin, to);
    } else {
      for (const line of this.lines) hull(line.column);
      if (this.band && whole) this.band.forEach(hull);
    }
    for (const mark of this.marks || []) {
      low = Math.min(low, mark);
      high = Math.max(high, mark);
    }
    const size = Math.max(Math.abs(low), Math.abs(high));
    this.range.fit(low, high, Math.max(this.least, 1e-6 * size, 1e-12));
  }

  settledHull(store, chosen, begin, to) {
    const rows = { low: [], high: [] };
    const collect = (column, into, edge) => store.each(chosen, column, to, (t, l, h) => {
      if (t >= begin && t <= to) into.push(edge ? h : l);
    });
    collect(this.band[0], rows.low, false);
    collect(this.band[1], rows.high, true);
    let smallest = Infinity;
    for (let i = 0; i < rows.low.length; i += 1) {
      const width = rows.high[i] - rows.low[i];
      if (width < smallest) smallest = width;
    }
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < rows.low.length; i += 1) {
      if (rows.high[i] - rows.low[i] > 6 * smallest) continue;
      low = Math.min(low, rows.low[i]);
      high = Math.max(high, rows.high[i]);
    }
    return [low, high];
  }

  level(context, p, y, dash, colour) {
    context.strokeStyle = colour;
    context.lineWidth = 1;
    context.setLineDash(dash);
    context.beginPath();
    context.moveTo(p.x, y);
    context.lineTo(p.x + p.w, y);
    context.stroke();
    context.setLineDash([]);
  }

  line(draw, { column, colour, width }) {
    const { y } = draw, gap = gapOf(draw.bounds);
    // Per pixel: place, top, bottom, and whether it goes on from the pixel before.
    const points = this.points;
    let size = 0, spread = 0, before = NaN, usual = Infinity;
    byPixel(draw, column, (at, low, high, begin, end) => {
      const top = y(high), bottom = y(low);
      points[size] = at;
      points[size + 1] = top;
      points[size + 2] = bottom;
      const step = begin - before;
      points[size + 3] = size > 0 && step <= Math.max(gap, 4 * usual) ? 1 : 0;
      if (step === step) usual = step;
      size = Math.min(size + 4, points.length - 4);
      spread += bottom - top;
      before = end;
    });
    if (spread > 2 * (size / 4)) bars(draw.context, points, size, colours[colour], width);
    else stroke(draw.context, points, size, colours[colour], width);
  }

  fill(draw) {
    const { context, y } = draw, edge = [];
    context.fillStyle = colours.band;
    context.beginPath();
    byPixel(draw, this.band[1], (at, low, high) => context.lineTo(at, y(high)));
    byPixel(draw, this.band[0], (at, low) => edge.push(at, y(low)));
    for (let i = edge.length - 2; i >= 0; i -= 2) context.lineTo(edge[i], edge[i + 1]);
    context.fill();
  }

  axes(context, p, [begin, end], low, high) {
    context.font = FONT;
    context.lineWidth = 1;
    const most = Math.max(2, Math.floor(p.h / 16));
    const round = ticks(low, high, most);
    // Constant lines are labelled themselves as long as they have room.
    const own = this.marks && high - low < 3 * (this.marks.at(-1) - this.marks[0]);
    const { step, values } = own ? { step: 1, values: [...this.marks, 0] } : round;
    const power = axisPower(low, high, step);
    const decimals = decimalsOf(step / 10 ** power);
    context.strokeStyle = colours.grid;
    context.fillStyle = colours.muted;
    context.textAlign = "right";
    context.textBaseline = "middle";
    context.beginPath();
    for (const value of values) {
      const y = Math.round(p.y + p.h - ((value - low) / (high - low)) * p.h) + 0.5;
      context.moveTo(p.x, y);
      context.lineTo(p.x + p.w, y);
      const text = minus((value / 10 ** power).toFixed(decimals)).replace(/^−(0(\.0+)?)$/, "$1");
      context.fillText(text, p.x - 6, y, GUTTER.left - 8); // squeezed where it would not fit
    }
    const label = this.widestLabel(context, begin, end);
    const along = ticks(begin, end, Math.max(1, Math.floor(p.w / (label + 22))));
    const timeDecimals = decimalsOf(along.step);
    context.textAlign = "center";
    context.textBaseline = "alphabetic";
    for (const time of along.values) {
      const x = Math.round(p.x + ((time - begin) / (end - begin)) * p.w) + 0.5;
      context.moveTo(x, p.y);
      context.lineTo(x, p.y + p.h);
      const text = minus(time.toFixed(timeDecimals)) + " s";
      const half = context.measureText(text).width / 2;
      context.fillText(text, Math.min(x, this.width - half - 1), p.y + p.h + 13);
    }
    context.stroke();
    context.strokeStyle = colours.line;
    context.strokeRect(p.x + 0.5, p.y + 0.5, p.w - 1, p.h - 1);
    context.textAlign = "left";
    const scale = power ? "×10" + superscript(power) : "";
    context.fillText([scale, this.unit.text || "no unit"].filter(Boolean).join(" "), 4, 11);
  }

  // Width of the widest time label that this window can have.
  widestLabel(context, begin, end) {
    const decimals = decimalsOf(Math.max((end - begin) / 6, 1e-6));
    const widest = Math.max(Math.abs(begin), Math.abs(end));
    return context.measureText(minus((-widest).toFixed(decimals)) + " s").width;
  }
}

// A smooth line.
function stroke(context, points, size, colour, width) {
  let last = NaN;
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineJoin = "bevel";
  context.beginPath();
  for (let i = 0; i < size; i += 4) {
    const at = points[i], top = points[i + 1], bottom = points[i + 2];
    // Of two values at one place the nearer first: a slope stays a slope.
    const [near, far] = Math.abs(bottom - last) < Math.abs(top - last) ? [bottom, top] : [top, bottom];
    if (points[i + 3]) context.lineTo(at, near); else context.moveTo(at, near);
    if (far !== near) context.lineTo(at, far);
    last = far;
  }
  context.stroke();
}

// Noise, which goes up and down within each pixel: a bar per pixel looks as a line does and is drawn much faster.
function bars(context, points, size, colour, width) {
  let above = NaN, below = NaN;
  context.fillStyle = colour;
  for (let i = 0; i < size; i += 4) {
    let top = points[i + 1], bottom = points[i + 2];
    const [ownTop, ownBottom] = [top, bottom];
    if (points[i + 3]) {
      if (top > below) top = below;
      if (bottom < above) bottom = above;
    }
    context.fillRect(Math.floor(points[i]), top - width / 2, 1, bottom - top + width);
    above = ownTop;
    below = ownBottom;
  }
}

// Calls visit(place, low, high, first time, last time) once for each pixel of the width that has values: drawing more
// would cost time and show the same.
function byPixel({ store, chosen, until, x, bounds }, column, visit) {
  let pixel = NaN, at = NaN, low = NaN, high = NaN, first = NaN, last = NaN;
  store.each(chosen, column, Math.min(bounds[1], until), (t, l, h) => {
    if (l !== l || t > until) return;
    const place = x(t), here = Math.floor(place);
    if (here === pixel) {
      if (l < low) low = l;
      if (h > high) high = h;
    } else {
      if (pixel === pixel) visit(at, low, high, first, last);
      pixel = here;
      at = place;
      low = l;
      high = h;
      first = t;
    }
    last = t;
  });
  if (pixel === pixel) visit(at, low, high, first, last);
}

// Without a sample for so long, s, a line is broken, unless samples are as far from each other before.
function gapOf([begin, end]) {
  return Math.max(1.5, (end - begin) / 50);
}
