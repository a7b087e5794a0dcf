#!/usr/bin/env python3
"""Draws the pictures of docs/architecture.md from the sources, so that they show what is there.

docs/images/crates.svg: the crates and who depends on whom, from `cargo metadata`.
docs/images/identification.svg: the folders of phugoid-identification and who imports from whom, from its `use` lines.
An arrow that follows from others (a needs b, b needs c, so a may use c) is left out, so that the picture stays readable.

Usage: scripts/draw-rooms.py            writes both pictures
       scripts/draw-rooms.py --check    fails if a committed picture is not what it would write
"""

import collections
import html
import importlib.util
import json
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
IMAGES = ROOT / "docs" / "images"

BOX_WIDTH, LINE, GAP_X, GAP_Y, MARGIN = 206, 15, 26, 44, 16
LETTERS = 33  # of a line of the description
LANE = 14  # width of an arrow that passes a row of boxes

# One line for each folder of phugoid-identification; a new folder without a line is an error.
FOLDERS = {
    "core": "plain data: options, methods, results, terms, errors",
    "model_file": "the model file (TOML)",
    "models": "equations of motion with exact Jacobians",
    "motion": "what a motion is to the estimation",
    "preparation": "samples from a record: inputs, noise, trim, excitation",
    "methods": "one run of a causal or batch method; rooms, table of methods",
    "batch": "equation error, output error, filter error",
    "judge": "verdict, readiness, offered terms, other axes",
    "pipeline": "estimate, session, monitor: what users call",
    "manoeuvres": "finds manoeuvres and what they can tell",
    "compatibility": "errors of the sensors, by kinematics",
    "inspect": "what a flight holds",
    "regress": "which terms a coefficient asks for",
    "draft": "a first model file, from a flight and a few answers",
    "aircraft": "a model file as an aircraft that flies",
    "export": "results for JSBSim, Gazebo, tables",
}


def crates():
    """Names with descriptions, and the dependencies of each among them."""
    packages = []
    for manifest in ["Cargo.toml", "bindings/python/Cargo.toml"]:
        command = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--manifest-path", str(ROOT / manifest)]
        packages += json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["packages"]
    for package in packages:
        if "bindings" in package["manifest_path"]:
            package["label"] = "bindings/python"
    names = {package["name"] for package in packages}
    labels = {package["name"]: package.get("label", package["name"]) for package in packages}
    text = {labels[p["name"]]: p["description"] or "" for p in packages}
    edges = {
        labels[p["name"]]: {labels[d["name"]]: 1 for d in p["dependencies"] if d["name"] in names and d["kind"] is None}
        for p in packages
    }
    return text, edges


def folders():
    """Folders of phugoid-identification with what they do, and the imports of each from the others."""
    spec = importlib.util.spec_from_file_location("circles", ROOT / "scripts" / "check-circles.py")
    circles = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(circles)
    _, imports = circles.graph(ROOT / "crates" / "phugoid-identification" / "src")
    edges = {module[0]: collections.Counter() for module in imports if module}
    for module, targets in imports.items():
        if module and module[-1] != "tests":
            edges[module[0]].update(target[0] for target in targets if target and target[0] != module[0])
    missing = sorted(set(edges) - set(FOLDERS))
    if missing:
        sys.exit(f"draw-rooms: say in FOLDERS what these are: {', '.join(missing)}")
    return {name: FOLDERS[name] for name in edges}, edges


def without_circles(edges):
    """The edges without those that close a circle, and those: the pair with fewer imports is the one that is taken out."""
    kept, back = {node: {} for node in edges}, []

    def reaches(start, goal):
        todo, seen = [start], set()
        while todo:
            node = todo.pop()
            if node == goal:
                return True
            if node not in seen:
                seen.add(node)
                todo.extend(kept[node])
        return False

    pairs = [(count, node, other) for node in edges for other, count in edges[node].items()]
    for count, node, other in sorted(pairs, key=lambda pair: (-pair[0], pair[1], pair[2])):
        if reaches(other, node):
            back.append((node, other))
        else:
            kept[node][other] = count
    return kept, sorted(back)


def reduced(edges):
    """Without the edges that follow from others."""

    def below(node, seen):
        for other in edges[node]:
            if other not in seen:
                seen.add(other)
                below(other, seen)
        return seen

    return {
        node: {o for o in others if not any(o in below(via, set()) for via in others if via != o)}
        for node, others in edges.items()
    }


def wrapped(text):
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + 1 + len(word) > LETTERS:
            lines.append("")
        lines[-1] = (lines[-1] + " " + word).strip()
    return [line for line in lines if line]


def layered(edges):
    """Rows of nodes, the topmost first, with a lane (None, ...) for each arrow that passes a row."""
    depth = {}

    def measure(node):
        if node not in depth:
            depth[node] = 1 + max((measure(other) for other in edges[node]), default=-1)
        return depth[node]

    for node in edges:
        measure(node)
    # Whatever nobody needs stands directly above what it needs; the rest as low as it can.
    top = max(depth.values())
    rows = [[] for _ in range(top + 1)]
    for node in sorted(edges):
        rows[top - depth[node]].append(node)
    links = []  # (upper, lower) between neighbouring rows
    for node in sorted(edges):
        for other in sorted(edges[node]):
            upper = node
            for level in range(depth[node] - 1, depth[other], -1):
                lane = (None, node, other, level)
                rows[top - level].append(lane)
                links.append((upper, lane))
                upper = lane
            links.append((upper, other))
    return rows, links


def crossings(rows, links):
    place = {node: (r, i) for r, row in enumerate(rows) for i, node in enumerate(row)}
    count = 0
    for i, (a, b) in enumerate(links):
        for c, d in links[i + 1 :]:
            if place[a][0] == place[c][0]:
                count += (place[a][1] - place[c][1]) * (place[b][1] - place[d][1]) < 0
    return count


def ordered(rows, links):
    """Orders each row by the mean place of its neighbours, up and down, and keeps the order with the fewest crossings."""
    up, down = {}, {}
    for a, b in links:
        down.setdefault(a, []).append(b)
        up.setdefault(b, []).append(a)
    best = [list(row) for row in rows]
    fewest = crossings(best, links)
    for sweep in range(40):
        neighbours = down if sweep % 2 else up
        indices = range(len(rows) - 1, -1, -1) if sweep % 2 else range(len(rows))
        for r in indices:
            place = {node: i / max(1, len(row) - 1) for row in rows for i, node in enumerate(row)}

            def mean(node):
                others = neighbours.get(node, [])
                return sum(place[o] for o in others) / len(others) if others else place[node]

            rows[r].sort(key=mean)
        # Neighbours change places where that takes crossings away.
        for row in rows:
            for i in range(len(row) - 1):
                before = crossings(rows, links)
                row[i], row[i + 1] = row[i + 1], row[i]
                if crossings(rows, links) >= before:
                    row[i], row[i + 1] = row[i + 1], row[i]
        if crossings(rows, links) < fewest:
            best, fewest = [list(row) for row in rows], crossings(rows, links)
    return best


def width(node):
    return LANE if isinstance(node, tuple) else BOX_WIDTH


def placed(rows, links):
    """The middle of each node, px: near its neighbours, without touching another one."""
    around = {}
    for a, b in links:
        around.setdefault(a, []).append(b)
        around.setdefault(b, []).append(a)
    x = {}
    for row in rows:
        left = 0
        for node in row:
            x[node] = left + width(node) / 2
            left += width(node) + GAP_X
    for _ in range(200):
        for row in rows:
            wish = [sum(x[o] for o in around[n]) / len(around[n]) if n in around else x[n] for n in row]
            # The nearest places to the wishes that keep the distances: blocks that touch share their mean wish.
            offsets, total = [], 0
            for i, node in enumerate(row):
                total += 0 if i == 0 else (width(row[i - 1]) + width(node)) / 2 + GAP_X
                offsets.append(total)
            blocks = []
            for i in range(len(row)):
                blocks.append([wish[i] - offsets[i], 1])
                while len(blocks) > 1 and blocks[-2][0] > blocks[-1][0]:
                    value, count = blocks.pop()
                    blocks[-1] = [
                        (blocks[-1][0] * blocks[-1][1] + value * count) / (blocks[-1][1] + count),
                        blocks[-1][1] + count,
                    ]
            i = 0
            for value, count in blocks:
                for _ in range(count):
                    x[row[i]] = value + offsets[i]
                    i += 1
    left = min(x[n] - width(n) / 2 for n in x)
    return {n: round(value - left + MARGIN, 1) for n, value in x.items()}


def picture(title, text, edges):
    kept, back = without_circles(edges)
    rows, links = layered(reduced(kept))
    rows = ordered(rows, links)
    x = placed(rows, links)
    lines = {name: wrapped(text[name]) for name in text}
    tops, heights, y = [], [], MARGIN
    for row in rows:
        height = 30 + LINE * max(len(lines[n]) for n in row if not isinstance(n, tuple))
        tops.append(y)
        heights.append(height)
        y += height + GAP_Y
    row_of = {node: r for r, row in enumerate(rows) for node in row}
    full_width = max(x[n] + width(n) / 2 for n in x) + MARGIN
    notes = [f"against the arrows: {upper} also imports from {lower}" for upper, lower in back]
    full_height = y - GAP_Y + MARGIN + (LINE * len(notes) + 6 if notes else 0)
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {full_width:.0f} {full_height:.0f}" width="{full_width:.0f}" '
        f'height="{full_height:.0f}" font-family="Inter, Helvetica, Arial, sans-serif">',
        f"<title>{html.escape(title)}</title>",
        "<!-- Written by scripts/draw-rooms.py; do not edit. -->",
        '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0 L8 4 L0 8 z" fill="#0072b2"/></marker></defs>',
        '<rect width="100%" height="100%" fill="#ffffff"/>',
    ]

    # Arrows leave and reach a box side by side, in the order of where they go.
    ports = {}
    for end, other in ((0, 1), (1, 0)):
        for node in row_of:
            own = sorted((link for link in links if link[end] == node), key=lambda link: x[link[other]])
            for i, link in enumerate(own):
                spread = 0 if isinstance(node, tuple) else (BOX_WIDTH - 60) * ((i + 1) / (len(own) + 1) - 0.5)
                ports[link, end] = x[node] + spread

    def chain(link):
        """The links from a box through lanes to a box."""
        whole = [link]
        while isinstance(whole[-1][1], tuple):
            whole.append(next(l for l in links if l[0] == whole[-1][1]))
        return whole

    for first in [link for link in links if not isinstance(link[0], tuple)]:
        path = []
        for link in chain(first):
            upper, lower = link
            x0, x1 = ports[link, 0], ports[link, 1]
            y0, y1 = tops[row_of[upper]] + heights[row_of[upper]], tops[row_of[lower]]
            if not path:
                path.append(f"M{x0:.1f} {y0}")
            else:
                # Through the row of the lane, straight down.
                path.append(f"L{x0:.1f} {y0}")
            middle = (y0 + y1) / 2
            path.append(f"C{x0:.1f} {middle:.1f} {x1:.1f} {middle:.1f} {x1:.1f} {y1 - (1 if not isinstance(lower, tuple) else 0)}")
        out.append(f'<path d="{" ".join(path)}" fill="none" stroke="#0072b2" stroke-width="1.4" marker-end="url(#head)"/>')
    for node in row_of:
        if isinstance(node, tuple):
            continue
        r = row_of[node]
        left = x[node] - BOX_WIDTH / 2
        out.append(
            f'<rect x="{left:.1f}" y="{tops[r]}" width="{BOX_WIDTH}" height="{heights[r]}" rx="6" fill="#f4f7fa" stroke="#30475e"/>'
        )
        out.append(
            f'<text x="{x[node]:.1f}" y="{tops[r] + 20}" text-anchor="middle" font-size="13" font-weight="600" '
            f'fill="#101820">{html.escape(node)}</text>'
        )
        for i, line in enumerate(lines[node]):
            out.append(
                f'<text x="{x[node]:.1f}" y="{tops[r] + 37 + LINE * i}" text-anchor="middle" font-size="11" '
                f'fill="#30475e">{html.escape(line)}</text>'
            )
    for i, note in enumerate(notes):
        place = full_height - 8 - LINE * (len(notes) - 1 - i)
        out.append(f'<text x="{MARGIN}" y="{place:.0f}" font-size="11" fill="#30475e">{html.escape(note)}</text>')
    out.append("</svg>")
    return "\n".join(out) + "\n"


def main():
    check = "--check" in sys.argv[1:]
    stale = []
    for name, title, (text, edges) in [
        ("crates.svg", "The crates and what each depends on", crates()),
        ("identification.svg", "The folders of phugoid-identification and what each imports from", folders()),
    ]:
        drawn = picture(title, text, edges)
        path = IMAGES / name
        if check:
            if not path.is_file() or path.read_text() != drawn:
                stale.append(str(path.relative_to(ROOT)))
        else:
            path.write_text(drawn)
            print(f"{path.relative_to(ROOT)}: {len(text)} boxes, {sum(map(len, edges.values()))} dependencies")
    if stale:
        sys.exit(f"{', '.join(stale)}: not what the sources say; run scripts/draw-rooms.py")


if __name__ == "__main__":
    main()
