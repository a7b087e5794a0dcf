#!/usr/bin/env python3
"""Lays out the pages of the repository for mdBook, and checks the site that it makes.

    scripts/site.py lay        the pages to target/site/src, with a table of contents, for book.toml
    scripts/site.py check      every link and every anchor of target/site/book leads somewhere

The README is the first page; the order of the others is that of its tables, and what stands in none of them comes after. So a
new page of docs/ is in the site without another list. Links to sources, which are no pages, become plain text.
"""

import html.parser
import posixpath
import re
import shutil
import sys
import urllib.parse
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SITE = ROOT / "target/site"
#: A link or a picture of Markdown: text, goal without anchor, anchor.
LINK = re.compile(r"(?P<picture>!?)\[(?P<text>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<goal>[^)#\s]*)(?P<anchor>#[^)\s]*)?\)")


def staged(page: str) -> str:
    """Where a page lies in the book: a README is the first page of its folder."""
    return re.sub(r"README\.md$", "index.md", page)


def pages() -> dict[str, list[str]]:
    """The pages by part of the book, in their order."""
    readme = (ROOT / "README.md").read_text()
    rows = re.findall(r"^\| \[[^\]]*\]\(([^)]+\.md)\)", readme, re.MULTILINE)
    crates = [page for page in rows if page.startswith(("crates/", "bindings/"))]
    there = sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs").glob("*.md"))
    others = [page for page in rows if page not in crates and page != "CHANGELOG.md"]
    return {
        "": ["README.md"],
        "Pages": others + [page for page in there if page not in others],
        "Crates": crates,
        "Project": ["CHANGELOG.md", "SECURITY.md"],
    }


def title(page: str) -> str:
    first = next(line for line in (ROOT / page).read_text().splitlines() if line.startswith("# "))
    return first.removeprefix("# ").strip()


def links_of(page: str, text: str, known: set[str], pictures: set[str]) -> str:
    def change(found: re.Match) -> str:
        goal, anchor = found["goal"], found["anchor"] or ""
        if not goal or "://" in goal or goal.startswith("mailto:"):
            return found[0]
        path = posixpath.normpath(posixpath.join(posixpath.dirname(page), goal))
        if not (ROOT / path).exists():
            sys.exit(f"site: {page} links to {goal}, which is not there")
        if found["picture"]:
            pictures.add(path)
            return found[0]
        if path in known:
            return f"[{found['text']}]({posixpath.relpath(staged(path), posixpath.dirname(page) or '.')}{anchor})"
        return found["text"]

    # A link's text may hold code, so that code is not cut out first; links in blocks of code are no links.
    blocks = re.split(r"(^```.*?^```$)", text, flags=re.MULTILINE | re.DOTALL)
    return "".join(part if k % 2 else LINK.sub(change, part) for k, part in enumerate(blocks))


def lay() -> None:
    parts = pages()
    known = {page for part in parts.values() for page in part}
    pictures: set[str] = set()
    shutil.rmtree(SITE / "src", ignore_errors=True)
    contents = ["# Summary", ""]
    for name, part in parts.items():
        if name:
            contents += ["", f"# {name}", ""]
        for page in part:
            words = title(page).replace("[", "\\[").replace("]", "\\]")
            contents.append(f"{'- ' if name else ''}[{words}]({staged(page)})")
            out = SITE / "src" / staged(page)
            out.parent.mkdir(parents=True, exist_ok=True)
            out.write_text(links_of(page, (ROOT / page).read_text(), known, pictures))
    for picture in pictures:
        (SITE / "src" / picture).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / picture, SITE / "src" / picture)
    (SITE / "src/SUMMARY.md").write_text("\n".join(contents) + "\n")
    print(f"site: {len(known)} pages, {len(pictures)} pictures")


class Page(html.parser.HTMLParser):
    """The anchors of a page, and where it leads."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.goals: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attributes) -> None:
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            if name in ("href", "src") and value and tag in ("a", "img", "link", "script"):
                self.goals.append(value)


def check() -> None:
    book = SITE / "book"
    # The page of a wrong address stands anywhere, so that its links count from the root.
    found = {file: Page(file.read_text()) for file in book.rglob("*.html") if file.name not in ("404.html", "toc.html")}
    broken, counted = [], 0
    for file, page in found.items():
        for goal in page.goals:
            parsed = urllib.parse.urlsplit(goal)
            if parsed.scheme or parsed.netloc:
                continue
            counted += 1
            target = (file.parent / urllib.parse.unquote(parsed.path)).resolve() if parsed.path else file
            if target.is_dir():
                target /= "index.html"
            anchor = urllib.parse.unquote(parsed.fragment)
            if not target.is_file():
                broken.append(f"{file.relative_to(book)}: {goal} is not there")
            elif anchor and target in found and anchor not in found[target].anchors:
                broken.append(f"{file.relative_to(book)}: {goal}: the page has no such heading")
    for line in sorted(set(broken)):
        print(line, file=sys.stderr)
    if broken or len(found) < 10:
        sys.exit(f"site: {len(set(broken))} links lead nowhere, {len(found)} pages")
    print(f"site: {counted} links of {len(found)} pages lead somewhere")


match sys.argv[1:]:
    case ["lay"]:
        lay()
    case ["check"]:
        check()
    case _:
        sys.exit(__doc__)
