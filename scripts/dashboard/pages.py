#!/usr/bin/env python3
"""What pages weigh, when they first show something, and whether they are wider than the window: for each page and width a line.

    target/python/bin/python scripts/dashboard/pages.py PAGE.html...

Each page is opened from its file, without a network, at 390, 1100 and 1900 px. Times are of this machine: the smallest of three.
"""

import pathlib
import sys

from chromium import Chromium

WIDTHS = (390, 1100, 1900)
PAINT = "performance.getEntriesByType('paint').find(e => e.name === 'first-contentful-paint')?.startTime ?? -1"


def main():
    print("| page | weight, kB | first paint at 390, 1100, 1900 px, ms | wider than the window by, px |")
    print("|---|---|---|---|")
    for name in sys.argv[1:]:
        page = pathlib.Path(name).resolve()
        paints, beyond = [], []
        for width in WIDTHS:
            found = []
            for _ in range(3):
                browser = Chromium(width=width, height=1000, mobile=width < 500)
                browser.open(page.as_uri())
                browser.until("document.readyState === 'complete'")
                browser.wait(0.3)
                found.append(browser.evaluate(PAINT))
                wide = browser.evaluate("document.documentElement.scrollWidth - document.documentElement.clientWidth")
                browser.close()
            paints.append(min(found))
            beyond.append(wide)
        shown = ", ".join(f"{paint:.0f}" for paint in paints)
        print(f"| {page.parent.name}/{page.name} | {page.stat().st_size / 1e3:.0f} | {shown} | {', '.join(map(str, beyond))} |", flush=True)


if __name__ == "__main__":
    main()
