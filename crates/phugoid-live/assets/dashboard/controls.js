// Mouse, touch, keys and buttons: what they do to the time window.
"use strict";

class Controls {
  constructor(view, panels) {
    this.view = view;
    this.panels = panels;
    this.cursor = NaN;
    this.marked = null;
    this.whole = false;
    this.changed = true;
    this.touches = new Map();
    byId("panels").addEventListener("pointerdown", (e) => this.down(e));
    byId("panels").addEventListener("pointermove", (e) => this.moved(e));
    byId("panels").addEventListener("pointerup", (e) => this.up(e));
    byId("panels").addEventListener("pointercancel", (e) => this.drop(e));
    byId("panels").addEventListener("pointerleave", () => this.set({ cursor: NaN }));
    byId("panels").addEventListener("dblclick", (e) => { if (e.target.chart) this.reset(); });
    byId("panels").addEventListener("wheel", (e) => this.wheel(e), { passive: false });
    document.addEventListener("keydown", (e) => this.key(e));
    byId("pause").onclick = () => this.pause();
    byId("follow").onclick = () => this.follow();
    byId("reset").onclick = () => this.reset();
    byId("scale").onclick = () => this.scale();
    byId("help-button").onclick = () => this.help();
    byId("help-close").onclick = () => byId("help").close();
    byId("span").onchange = (e) => {
      this.view.show(Number(e.target.value));
      this.change();
    };
    byId("symbols").append(...Object.values(VERDICTS).map(([symbol, text]) => element("span", "", `${symbol} ${text}`)));
  }

  set(state) {
    Object.assign(this, state);
    this.changed = true;
  }

  // The window has been moved: buttons say so, scales are fitted exactly.
  change() {
    for (const chart of this.panels.charts) chart.range.forget();
    byId("pause").setAttribute("aria-pressed", String(this.view.paused));
    setText(byId("pause"), this.view.paused ? "Go on" : "Pause");
    byId("follow").setAttribute("aria-pressed", String(this.view.following && !this.view.paused));
    setText(byId("scale"), this.whole ? "Scale: whole" : "Scale: settled");
    const spans = byId("span"), known = [...spans.options].some((o) => o.value === String(this.view.span));
    spans.value = known ? String(this.view.span) : "custom";
    this.changed = true;
  }

  pause() { this.view.pause(!this.view.paused); this.change(); }
  follow() { this.view.follow(); this.change(); }
  scale() { this.whole = !this.whole; this.change(); }
  help() { const help = byId("help"); if (help.open) help.close(); else help.showModal(); }

  reset() {
    this.view.span = this.usual || 60;
    this.view.follow();
    this.change();
  }

  move(part) {
    const [begin, end] = this.view.bounds();
    this.view.move(part * (end - begin));
    this.change();
  }

  zoom(factor, about) { this.view.zoom(factor, about); this.change(); }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select,input")) return;
    const actions = {
      " ": () => this.pause(), f: () => this.follow(), r: () => this.reset(), y: () => this.scale(), "?": () => this.help(),
      ArrowLeft: () => this.move(event.shiftKey ? -1 : -0.2), ArrowRight: () => this.move(event.shiftKey ? 1 : 0.2),
      "+": () => this.zoom(1 / 1.5), "=": () => this.zoom(1 / 1.5), "-": () => this.zoom(1.5), "_": () => this.zoom(1.5),
    };
    const action = actions[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!action || (byId("help").open && event.key !== "?")) return;
    // A focused button would take the space bar for itself as well.
    event.preventDefault();
    action();
  }

  wheel(event) {
    const chart = event.target.chart;
    if (!chart || !(event.ctrlKey || event.metaKey || event.shiftKey)) return;
    event.preventDefault();
    const turned = Math.abs(event.deltaY) >= Math.abs(event.deltaX) ? event.deltaY : event.deltaX;
    if (event.shiftKey) this.move(turned / 800);
    else this.zoom(Math.exp(Math.max(-120, Math.min(120, turned)) / 240), chart.timeAt(event.offsetX));
  }

  down(event) {
    const chart = event.target.chart;
    if (!chart || event.button !== 0) return;
    this.touches.set(event.pointerId, event.clientX);
    if (this.touches.size > 1) {
      this.drag = null;
      this.marked = null;
      this.pinch = this.spread();
      return;
    }
    const mode = event.shiftKey || event.pointerType === "touch" ? "move" : "mark";
    this.drag = { chart, mode, x: event.clientX, bounds: this.view.bounds(), from: chart.timeAt(event.offsetX) };
    if (event.pointerType !== "touch") event.target.setPointerCapture(event.pointerId);
  }

  spread() {
    const places = [...this.touches.values()];
    return Math.max(Math.abs(places[0] - places[1]), 10);
  }

  moved(event) {
    const chart = event.target.chart;
    if (this.touches.has(event.pointerId)) this.touches.set(event.pointerId, event.clientX);
    if (this.pinch && this.touches.size === 2) {
      const spread = this.spread();
      this.zoom(this.pinch / spread);
      this.pinch = spread;
      return;
    }
    const drag = this.drag;
    if (!drag) {
      if (event.pointerType !== "touch") this.set({ cursor: chart ? chart.timeAt(event.offsetX) : NaN });
      return;
    }
    const [begin, end] = drag.bounds;
    const shift = event.clientX - drag.x;
    if (drag.mode === "move") {
      const seconds = (-shift / drag.chart.plot().w) * (end - begin);
      if (Math.abs(shift) > 3) {
        this.view.place(begin + seconds, end + seconds);
        this.change();
      }
    } else {
      // A mark is laid over the window as it was when the drag began; pause would hide that data go on.
      const to = drag.from + (shift / drag.chart.plot().w) * (end - begin);
      const clipped = Math.min(Math.max(to, begin), end);
      this.set({ marked: Math.abs(shift) > 3 ? [Math.min(drag.from, clipped), Math.max(drag.from, clipped)] : null });
    }
  }

  up(event) {
    const marked = this.marked;
    this.drop(event);
    if (!marked) return;
    this.view.place(marked[0], marked[1]);
    this.change();
  }

  drop(event) {
    this.touches.delete(event.pointerId);
    if (this.touches.size < 2) this.pinch = null;
    this.set({ drag: null, marked: null });
  }
}
