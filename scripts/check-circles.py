#!/usr/bin/env python3
"""Finds circles of imports between the files of each crate.

A circle is a set of files of which each imports, directly or through others of the set, every other one. Parent
modules that only declare and re-export are resolved to the file that defines the imported name as far as the text tells.
Fails when a circle has more than two files or crosses a folder. Usage: scripts/check-circles.py [CRATE_FOLDER ...]
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def files_of(source):
    """Module path (tuple of names) of every file below a src folder."""
    found = {}
    for path in sorted(source.rglob("*.rs")):
        parts = list(path.relative_to(source).with_suffix("").parts)
        if parts[0] in ("bin",):
            continue
        if parts[-1] in ("mod", "lib", "main"):
            parts = parts[:-1]
        found[tuple(parts)] = path
    return found


def without_tests(text):
    """The text without comments and without what is compiled for tests alone."""
    text = re.sub(r"//[^\n]*", "", text)
    return re.split(r"#\[cfg\(test\)\]\s*\n\s*(?:#\[path[^\n]*\n\s*)?mod \w+\s*\{", text)[0]


def expand(tree):
    """Paths of the text of a use declaration, braces expanded."""
    tree = tree.strip()
    brace = tree.find("{")
    if brace < 0:
        return [tree.split(" as ")[0].strip()] if tree else []
    head, depth, parts, start = tree[:brace], 0, [], brace + 1
    for i in range(brace, len(tree)):
        if tree[i] == "{":
            depth += 1
        elif tree[i] == "}":
            depth -= 1
            if depth == 0:
                parts.append(tree[start:i])
                break
        elif tree[i] == "," and depth == 1:
            parts.append(tree[start:i])
            start = i + 1
    return [head + path for part in parts for path in expand(part)]


def absolute(path, module):
    """Names of a path from the root of the crate; none for a path of another crate."""
    names = [n.strip() for n in path.split("::") if n.strip()]
    if not names:
        return None
    if names[0] == "crate":
        return names[1:]
    if names[0] == "self":
        return list(module) + names[1:]
    if names[0] == "super":
        base = list(module)
        while names and names[0] == "super":
            base, names = base[:-1], names[1:]
        return base + names
    return None


def graph(source):
    modules = files_of(source)
    text = {m: without_tests(p.read_text()) for m, p in modules.items()}
    uses, exports = {}, {}
    for module, content in text.items():
        found = []
        for visibility, tree in re.findall(r"(pub(?:\([^)]*\))?\s+)?use\s+([^;]+);", content):
            for path in expand(tree):
                names = absolute(path, module)
                first = path.split("::")[0].strip()
                if names is None and module + (first,) in modules:
                    names = list(module) + [n.strip() for n in path.split("::")]
                if names is None:
                    continue
                found.append(names)
                if visibility:
                    exports.setdefault(module, {})[names[-1]] = names
        rest = re.sub(r"use\s+[^;]+;", "", content)
        for path in re.findall(r"\b(?:crate|super)(?:::\w+)+", rest):
            names = absolute(path, module)
            if names:
                found.append(names)
        uses[module] = found

    def resolve(names, depth=0):
        """The file that defines what a path names."""
        for length in range(len(names), -1, -1):
            module = tuple(names[:length])
            if module not in modules:
                continue
            if length < len(names) and depth < 8:
                target = exports.get(module, {}).get(names[length])
                if target is not None and target != names:
                    return resolve(target + names[length + 1 :], depth + 1)
            return module
        return None

    edges = {m: set() for m in modules}
    for module, paths in uses.items():
        for names in paths:
            target = resolve(names)
            # Declaring a child is not an import, and neither is a glob over one's own child.
            if target is not None and target != module and target != ():
                edges[module].add(target)
    # A file that re-exports does not depend on what it passes on.
    for module, names in exports.items():
        for target in names.values():
            found = resolve(target)
            own_text = re.sub(r"pub(?:\([^)]*\))?\s+use\s+[^;]+;", "", text[module])
            if found in edges[module] and not re.search(r"\b%s\b" % re.escape(target[-1]), own_text):
                edges[module].discard(found)
    return modules, edges


def components(edges):
    """Strongly connected components (Tarjan)."""
    index, low, stack, on, out, counter = {}, {}, [], set(), [], [0]
    sys.setrecursionlimit(10000)

    def visit(node):
        index[node] = low[node] = counter[0]
        counter[0] += 1
        stack.append(node)
        on.add(node)
        for other in edges[node]:
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in on:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            group = []
            while True:
                other = stack.pop()
                on.discard(other)
                group.append(other)
                if other == node:
                    break
            out.append(group)

    for node in edges:
        if node not in index:
            visit(node)
    return out


def main():
    crates = [pathlib.Path(a) for a in sys.argv[1:]] or sorted((ROOT / "crates").iterdir())
    failed = False
    for crate in crates:
        source = crate / "src"
        if not source.is_dir():
            continue
        modules, edges = graph(source)
        for group in components(edges):
            if len(group) < 2:
                continue
            # A folder's own file (`x.rs` or `x/mod.rs`) belongs to the folder `x`, and so do the files in it.
            folders = {g if any(len(m) > len(g) and m[: len(g)] == g for m in modules) else g[:-1] for g in group}
            if len(group) > 2 or len(folders) > 1:
                failed = True
                print(f"{crate.name}: a circle of {len(group)} files in {len(folders)} folders:")
                for module in sorted(group):
                    to = sorted("::".join(t) for t in edges[module] if t in group)
                    print(f"    {'::'.join(module)} -> {', '.join(to)}")
    if failed:
        sys.exit("circles of imports: let both sides use a third file, or move what one needs of the other")
    print("no circle of more than two files, none across folders")


if __name__ == "__main__":
    main()
