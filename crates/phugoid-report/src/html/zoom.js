/* Zoom and pan of the time histories: a part of the time is shown in all figures of the same time at once. The page is whole
   without this script; with it each figure gets a row of buttons, and a span that is drawn with the mouse is enlarged. */
(() => {
  "use strict";
  const made = (svg, name, attributes) => {
    const element = document.createElementNS(svg.namespaceURI, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    return element;
  };
  const numbers = (text) => text.split(" ").map(Number);
  /* A path of the page has whole numbers and only these commands; all but M count from the point before. */
  const parsed = (path) =>
    [...path.matchAll(/([MmlhzZ])([^MmlhzZ]*)/g)].map(([, command, rest]) => [command, (rest.match(/-?\d+/g) || []).map(Number)]);
  const stretched = (commands, by, shift) =>
    commands
      .map(([command, values]) => {
        const pairs = command !== "h";
        const moved = values.map((v, k) => (pairs && k % 2 ? v : +(v * by + (command === "M" ? shift : 0)).toFixed(1)));
        return command + moved.join(" ");
      })
      .join("");
  /* Multiples of 1, 2 or 5 times a power of ten, as the page has them. */
  const ticks = (low, high, wanted) => {
    const raw = (high - low) / Math.max(1, wanted);
    const power = 10 ** Math.floor(Math.log10(raw));
    const step = power * [1, 2, 5, 10].find((m) => m * power >= raw * 0.999);
    const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const out = [];
    for (let n = Math.ceil(low / step - 1e-9); high + 1e-9 * step >= n * step; n += 1) {
      out.push([n * step, (n * step).toFixed(decimals).replace("-", "\u2212")]);
    }
    return out;
  };

  let count = 0;
  const plots = [...document.querySelectorAll("svg g.plot")].map((group) => {
    const svg = group.ownerSVGElement;
    const [left, top, right, bottom] = numbers(group.dataset.frame);
    const clip = made(svg, "clipPath", { id: `part-${(count += 1)}` });
    clip.append(made(svg, "rect", { x: left, y: top - 10, width: right - left, height: bottom - top + 20 }));
    svg.prepend(clip);
    const next = group.nextElementSibling;
    let labels = next;
    while (labels && !(labels.matches("g.labels") || labels.matches("g.plot"))) labels = labels.nextElementSibling;
    return {
      group, svg, left, top, right, bottom, clip,
      whole: numbers(group.dataset.time),
      key: group.dataset.time,
      grid: group.querySelector("path.grid"),
      paths: [...group.querySelectorAll("path:not(.grid)")].map((path) => [path, path.getAttribute("d"), parsed(path.getAttribute("d"))]),
      labels: labels && labels.matches("g.labels") ? labels : null,
    };
  });
  if (!plots.length) return;
  for (const plot of plots) {
    plot.gridWas = plot.grid && plot.grid.getAttribute("d");
    plot.labelsWere = plot.labels && plot.labels.innerHTML;
  }

  const views = new Map(plots.map((plot) => [plot.key, plot.whole]));
  const told = [];
  const show = (key, from, to) => {
    const [first, last] = numbers(key);
    /* A page has a thousand points in its width: deeper there is nothing more to see. */
    const span = Math.min(last - first, Math.max((last - first) / 50, to - from));
    const begin = Math.min(Math.max(first, from), last - span);
    const isWhole = span >= (last - first) * 0.999;
    const view = isWhole ? [first, last] : [begin, begin + span];
    views.set(key, view);
    for (const plot of plots.filter((p) => p.key === key)) draw(plot, view, isWhole);
    for (const tell of told) tell();
  };
  const draw = (plot, [from, to], isWhole) => {
    const { group, left, right, top, bottom, whole, clip } = plot;
    if (isWhole) {
      group.removeAttribute("clip-path");
      for (const [path, was] of plot.paths) path.setAttribute("d", was);
      if (plot.grid) plot.grid.setAttribute("d", plot.gridWas);
      if (plot.labels) plot.labels.innerHTML = plot.labelsWere;
      return;
    }
    const by = (whole[1] - whole[0]) / (to - from);
    const shift = left - left * by - ((from - whole[0]) / (to - from)) * (right - left);
    group.setAttribute("clip-path", "url" + `(#${clip.id})`);
    for (const [path, , commands] of plot.paths) path.setAttribute("d", stretched(commands, by, shift));
    const marks = ticks(from, to, Math.min(12, Math.max(2, (right - left) / 1000)));
    const at = (time) => +(left + ((time - from) / (to - from)) * (right - left)).toFixed(1);
    if (plot.grid) plot.grid.setAttribute("d", marks.map(([time]) => `M${at(time)} ${top}l0 ${bottom - top}`).join("") || "M0 0");
    if (plot.labels) {
      const like = plot.labels.querySelector("text");
      if (!like) return;
      plot.labels.replaceChildren(
        ...marks.map(([time, words]) => {
          const text = like.cloneNode(false);
          text.setAttribute("x", at(time));
          text.textContent = words;
          return text;
        }),
      );
    }
  };

  for (const svg of new Set(plots.map((plot) => plot.svg))) {
    const own = plots.filter((plot) => plot.svg === svg);
    const key = own[0].key;
    const bar = document.createElement("div");
    bar.className = "zoom";
    bar.setAttribute("role", "group");
    bar.setAttribute("aria-label", "Part of the time that is shown");
    const says = document.createElement("span");
    const tell = () => {
      const [from, to] = views.get(key);
      const digits = Math.max(0, 2 - Math.floor(Math.log10(to - from)));
      const words = [from, to].map((time) => String(+time.toFixed(digits)).replace("-", "\u2212"));
      says.textContent = `${words[0]} to ${words[1]} s`;
    };
    const button = (words, name, does) => {
      const one = document.createElement("button");
      one.type = "button";
      one.textContent = words;
      one.title = name;
      one.setAttribute("aria-label", name);
      one.addEventListener("click", () => {
        const [from, to] = views.get(key);
        does(from, to, (from + to) / 2, to - from);
      });
      bar.append(one);
    };
    button("+", "Enlarge the middle", (from, to, middle, span) => show(key, middle - span / 4, middle + span / 4));
    button("\u2212", "Show more time", (from, to, middle, span) => show(key, middle - span, middle + span));
    button("\u2039", "Earlier", (from, to, middle, span) => show(key, from - span / 2, to - span / 2));
    button("\u203a", "Later", (from, to, middle, span) => show(key, from + span / 2, to + span / 2));
    button("whole", "Show the whole time", () => show(key, ...numbers(key)));
    bar.append(says);
    bar.title = "Draw over a figure to enlarge that part; shift and draw to move it; a double click shows the whole.";
    const scroll = svg.closest("div.scroll") || svg;
    scroll.before(bar);
    told.push(tell);
    tell();

    svg.classList.add("zooms");
    const place = (event) => {
      const box = svg.getBoundingClientRect();
      const scale = svg.viewBox.baseVal.width / box.width;
      return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    };
    const time = (plot, x) => {
      const [from, to] = views.get(key);
      return from + ((x - plot.left) / (plot.right - plot.left)) * (to - from);
    };
    let drag = null;
    const leave = () => {
      if (drag && drag.mark) drag.mark.remove();
      drag = null;
    };
    svg.addEventListener("pointerdown", (event) => {
      /* A finger scrolls the page; it has the buttons. */
      if (event.button !== 0 || event.pointerType === "touch") return;
      const [x, y] = place(event);
      const plot = own.find((p) => x >= p.left && p.right >= x && y >= p.top && p.bottom >= y);
      if (!plot) return;
      drag = { plot, x, view: views.get(key), moves: event.shiftKey, mark: null };
      if (!drag.moves) {
        drag.mark = made(svg, "rect", { y: plot.top, height: plot.bottom - plot.top, x, width: 0, fill: "var(--blue)", "fill-opacity": 0.18 });
        svg.append(drag.mark);
      }
      /* An event that a program makes has no pointer to hold. */
      if (event.isTrusted) svg.setPointerCapture(event.pointerId);
      event.preventDefault();
    });
    svg.addEventListener("pointermove", (event) => {
      if (!drag) return;
      const [x] = place(event);
      if (drag.moves) {
        const [from, to] = drag.view;
        const by = ((drag.x - x) / (drag.plot.right - drag.plot.left)) * (to - from);
        show(key, from + by, to + by);
        return;
      }
      const inside = Math.min(drag.plot.right, Math.max(drag.plot.left, x));
      drag.mark.setAttribute("x", Math.min(inside, drag.x));
      drag.mark.setAttribute("width", Math.abs(inside - drag.x));
    });
    svg.addEventListener("pointerup", (event) => {
      if (!drag) return;
      const { plot, x, moves } = drag;
      const end = Math.min(plot.right, Math.max(plot.left, place(event)[0]));
      leave();
      /* A click that trembles is no span. */
      if (!moves && Math.abs(end - x) > 60) show(key, time(plot, Math.min(x, end)), time(plot, Math.max(x, end)));
    });
    svg.addEventListener("pointercancel", leave);
    svg.addEventListener("dblclick", () => show(key, ...numbers(key)));
  }
})();
