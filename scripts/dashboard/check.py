"""Checks the dashboard in headless Chromium against synthetic streams: states told in words, keys and mouse, no error in
the console, no request elsewhere, no sideways scrolling on a phone. With `--measure SECONDS` also the frames per second
at 100 Hz with 11 parameters, and with `--memory` the memory over 30 minutes of data. No time is a condition: numbers that
depend on the machine are printed.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

from chromium import Chromium
from synthetic import PARAMETERS, Server, page

failures = []


def check(what, true, found=""):
    print(f"  {'ok  ' if true else 'FAIL'} {what}" + (f" ({found})" if found != "" else ""), flush=True)
    if not true:
        failures.append(what)


def status(browser):
    return browser.evaluate("document.getElementById('status').textContent.trim()")


def notice(browser):
    return browser.evaluate("document.getElementById('notice').hidden ? '' : document.getElementById('notice').textContent")


class Page:
    """A browser on a page with one kind of stream."""

    def __init__(self, mode, picture=None, **screen):
        server = screen.pop("server", {})
        self.server, self.picture = Server(mode, text=TEXT, **server), picture
        self.browser = Chromium(**screen)
        self.browser.open(self.server.address)

    def __enter__(self):
        return self.browser

    def __exit__(self, kind, *_):
        try:
            if kind is None:
                wide = self.browser.evaluate("document.documentElement.scrollWidth - innerWidth")
                check("nothing reaches beyond the window's width", wide <= 0, f"{wide} px")
                expected = "503 (Service Unavailable)"  # The check of a lost connection refuses the page's second try.
                troubles = [t for t in self.browser.troubles if expected not in t]
                check("no error in the console, no request elsewhere", not troubles, "; ".join(troubles))
                if self.picture and PICTURES:
                    self.browser.screenshot(Path(PICTURES) / self.picture)
        finally:
            self.browser.close()
            self.server.close()


def running():
    print("a running flight")
    with Page("backlog", "desktop.png", width=1400, height=1150) as browser:
        browser.until("window.phugoid && phugoid.flight.estimates > 5900")
        browser.until("phugoid.statistics.drawn > 3")
        paint = browser.evaluate("performance.getEntriesByType('paint').find(e => e.name === 'first-contentful-paint').startTime")
        print(f"       first contentful paint after {paint:.0f} ms")
        browser.until("document.getElementById('status')?.className === 'live'")
        check("it says that it is live", status(browser).startswith("●Live"), status(browser))
        cards = browser.evaluate("[...document.querySelectorAll('#parameters .card')].map(c => c.textContent)")
        check("every parameter has a card", len(cards) == len(PARAMETERS), len(cards))
        check("a value has its bound and unit", "±" in cards[5] and "per rad" in cards[5], cards[5])
        words = ("✓converged", "↗improving", "○not excited")
        check("verdicts have symbol and words", all(any(w in c for c in cards) for w in words))
        check("charts are drawn", browser.evaluate(INK) > 500)
        events = browser.evaluate("document.querySelectorAll('#events li').length")
        check("events are listed", events == 3, events)
        link = browser.evaluate("document.getElementById('link').textContent")
        check("the link is told", "lost" in link and "latency" in link and "99.9 %" in link)
        keys(browser)
        mouse(browser)
        restarts(browser)


# Pixels of the first chart that are not empty.
INK = """(() => { const c = document.querySelector('#parameters canvas');
  return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.filter((v, i) => i % 4 === 3 && v > 0).length; })()"""


def keys(browser):
    span = "phugoid.view.bounds()[1] - phugoid.view.bounds()[0]"
    browser.press(" ", " ")
    at = browser.evaluate("phugoid.view.bounds()[1]")
    browser.until("document.getElementById('status')?.className === 'paused'")
    browser.wait(0.5)
    check("space pauses the picture", browser.evaluate("phugoid.view.bounds()[1]") == at)
    check("data are kept meanwhile", browser.evaluate("phugoid.flight.store.last") > at)
    browser.press(" ", " ")
    browser.wait(0.3)
    check("space goes on", browser.evaluate("phugoid.view.bounds()[1]") > at)
    before = browser.evaluate(span)
    browser.press("+", "+")
    check("plus shows a shorter time", abs(browser.evaluate(span) - before / 1.5) < 0.1, browser.evaluate(span))
    browser.press("-", "-")
    check("minus shows a longer time", abs(browser.evaluate(span) - before) < 1)
    browser.press("ArrowLeft")
    check("left goes back and stops following", not browser.evaluate("phugoid.view.following"))
    browser.press("+", "+")
    begin = browser.evaluate("phugoid.view.bounds()[0]")
    browser.press("ArrowRight")
    check("right goes on", browser.evaluate("phugoid.view.bounds()[0]") > begin)
    browser.press("f", "f")
    check("f follows", browser.evaluate("phugoid.view.following"))
    browser.press("y", "y")
    check("y changes the scale of the parameters", browser.evaluate("phugoid.controls.whole"))
    browser.press("y", "y")
    browser.press("?", "?")
    check("the question mark opens the help", browser.evaluate("document.getElementById('help').open"))
    browser.press("Escape")
    browser.wait(0.2)
    check("escape closes it", not browser.evaluate("document.getElementById('help').open"))
    browser.press("r", "r")


def mouse(browser):
    left, top, width = browser.evaluate("""(() => { const b = document.querySelector('#parameters canvas').getBoundingClientRect();
      return [b.left, b.top, b.width]; })()""")
    shown = browser.evaluate("phugoid.view.bounds()")
    browser.drag((left + 0.4 * width, top + 60), (left + 0.7 * width, top + 60))
    now = browser.evaluate("phugoid.view.bounds()")
    check("dragging zooms to what is marked", 0.15 < (now[1] - now[0]) / (shown[1] - shown[0]) < 0.45, now)
    browser.mouse("mouseWheel", left + 0.5 * width, top + 60, deltaX=0, deltaY=-100, modifiers=2)
    browser.wait(0.3)
    closer = browser.evaluate("phugoid.view.bounds()")
    check("Ctrl and wheel zoom", closer[1] - closer[0] < now[1] - now[0], closer)
    browser.mouse("mouseMoved", left + 0.5 * width, top + 60)
    check("the pointer shows a time in all charts", browser.evaluate("Number.isFinite(phugoid.controls.cursor)"))
    for count in (1, 2):
        browser.mouse("mousePressed", left + 0.5 * width, top + 60, button="left", clickCount=count)
        browser.mouse("mouseReleased", left + 0.5 * width, top + 60, button="left", clickCount=count)
    check("a double click resets", browser.evaluate("phugoid.view.following && phugoid.view.span === 60"))
    browser.mouse("mouseMoved", 5, 5)
    browser.wait(0.3)


def restarts(browser):
    """What a server says to a page that comes back: all of the past again, or that of another start."""
    browser.evaluate("phugoid.stream.source.close()")
    again = "var f = phugoid.flight; f.take({ ...f.hello }); f.take({ ...f.newest, type: 'estimate', time_s: %s });"
    kept = browser.evaluate(again % "f.store.first" + " f.estimates > 5900")
    check("after a break of the connection what was received stays", kept)
    dropped = browser.evaluate(again % "f.store.first + 0.5" + "f.estimates === 1 && f.store.received === 1")
    check("another start of the server begins anew", dropped)


def states():
    print("waiting")
    with Page("waiting", "waiting.png", width=900, height=500) as browser:
        browser.until("document.getElementById('waiting-note')?.textContent?.includes('1.2 s of 2.0 s')")
        check("it says what it waits for", True)
    print("a silent sender")
    with Page("stale", "stale.png", width=1000, height=700, dark=True) as browser:
        browser.until("document.getElementById('status')?.className === 'stale'")
        browser.until("document.getElementById('notice').textContent.includes('The sender is silent')")
        check("it says that the data are old", True, notice(browser))
    print("an ended stream")
    with Page("ended", "ended.png", width=1000, height=700) as browser:
        browser.until("document.getElementById('status')?.className === 'ended'")
        check("it says why", "the source has ended" in notice(browser), notice(browser))
    print("a lost connection")
    with Page("lost", "lost.png", width=1000, height=700) as browser:
        browser.until("document.getElementById('status')?.className === 'error'")
        check("it says so and tries again", "trying again" in notice(browser), notice(browser))
        browser.until("window.phugoid && phugoid.flight.estimates > 5900")
    print("a phone")
    with Page("backlog", "phone.png", width=360, height=740, dark=True, mobile=True, scale=2) as browser:
        browser.until("window.phugoid && phugoid.flight.estimates > 5900")
        browser.until("document.getElementById('status')?.className === 'live'")
        columns = browser.evaluate("getComputedStyle(document.getElementById('parameters')).gridTemplateColumns.split(' ').length")
        check("one column", columns == 1, columns)
        browser.wait(0.5)


def frames(seconds):
    print(f"frames per second over {seconds:.0f} s at 100 Hz with 11 parameters")
    with Page("live", width=1400, height=2200) as browser:
        browser.until("window.phugoid && phugoid.statistics.drawn > 10")
        counted = "[performance.now(), phugoid.statistics.frames, phugoid.statistics.drawn, phugoid.flight.estimates]"
        first = browser.evaluate(counted)
        browser.wait(seconds)
        last = browser.evaluate(counted)
        passed = (last[0] - first[0]) / 1000
        rates = [(b - a) / passed for a, b in zip(first[1:], last[1:])]
        print(f"       {rates[0]:.1f} frames, {rates[1]:.1f} pictures of all 27 charts, {rates[2]:.1f} estimates per second;"
              f" slowest picture {browser.evaluate('phugoid.statistics.slowest_ms'):.0f} ms;"
              f" load {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        check("estimates arrive at their rate", rates[2] > 90, f"{rates[2]:.1f}/s")


def memory(minutes=30):
    """Thirty minutes of stream, many times faster than real time."""
    speed = 60.0
    print(f"memory over {minutes} minutes of data at 100 Hz, fed as fast as the page takes them (at most {speed:.0f} times)")
    with Page("live", width=1400, height=1000, server={"speed": speed, "seconds": minutes * 60.0}) as browser:
        heaps = []
        for minute in sorted({1, 2, 5, 10, 15, 20, 25, minutes}):
            browser.until(f"window.phugoid && phugoid.flight.store.last >= {minute * 60 + 1.9}", 600)
            browser.evaluate("(gc(), gc(), 0)")
            heap = browser.evaluate("performance.memory.usedJSHeapSize") / 1e6
            nodes = {m["name"]: m["value"] for m in browser.call("Performance.getMetrics")["metrics"]}
            heaps.append(heap)
            print(f"       {minute:3d} min: JavaScript heap and buffers {heap:.2f} MB, {nodes['Nodes']:.0f} nodes,"
                  f" {browser.evaluate('phugoid.flight.estimates')} estimates", flush=True)
        # What is kept per estimate for ever would show: 150 000 estimates of 60 numbers would be 70 MB.
        # What waits to be collected makes some megabytes either way.
        check("memory is flat from the fifth minute on", heaps[-1] - heaps[2] < 10.0, f"{heaps[-1] - heaps[2]:+.2f} MB")


parser = argparse.ArgumentParser()
parser.add_argument("--page", help="file of the assembled page; without it, it is assembled from the assets")
parser.add_argument("--pictures", help="folder for screenshots")
parser.add_argument("--measure", type=float, metavar="SECONDS", help="measure frames per second for so long")
parser.add_argument("--memory", action="store_true", help="measure memory over 30 minutes of data")
arguments = parser.parse_args()
TEXT = Path(arguments.page).read_text() if arguments.page else page()
PICTURES = arguments.pictures
if PICTURES:
    Path(PICTURES).mkdir(parents=True, exist_ok=True)
if arguments.measure:
    frames(arguments.measure)
if arguments.memory:
    memory()
if not (arguments.measure or arguments.memory):
    running()
    states()
if failures:
    sys.exit("check-dashboard: " + "; ".join(failures))
print("check-dashboard: all checks passed")
