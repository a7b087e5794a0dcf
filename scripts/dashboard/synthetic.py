"""A synthetic stream of `phugoid live`, and a server that feeds it to the dashboard, for checking the page alone.

The documents have the form of the real ones; the numbers are made up: parameters that settle while their bounds shrink,
outputs that answer a train of elevator pulses, a change in the middle of the events.
"""

import json
import math
import random
import re
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

ASSETS = Path(__file__).resolve().parents[2] / "crates/phugoid-live/assets/dashboard"

# Value, bound at the start, time constant of the bound in s: as of a longitudinal model with 11 parameters.
PARAMETERS = [
    ("CD_0", 0.1239, 0.06, 3, "-"), ("CD_V", -0.0654, 0.05, 6, "-"), ("CD_alpha", 0.317, 0.3, 4, "per rad"),
    ("CL_0", -0.0939, 0.5, 20, "-"), ("CL_V", 0.1516, 0.4, 30, "-"), ("CL_alpha", 4.308, 2.0, 1.5, "per rad"),
    ("Cm_0", 0.1154, 0.2, 5, "-"), ("Cm_V", 0.0034, 0.1, 1e9, "-"), ("Cm_alpha", -0.9976, 0.6, 1, "per rad"),
    ("Cm_q", -35.71, 20, 2, "per rad"), ("Cm_elevator", -1.575, 0.9, 1.2, "per rad"),
]
OUTPUTS = [("true_airspeed", "m/s", 0.13), ("alpha", "rad", 0.001), ("theta", "rad", 0.0005), ("q", "rad/s", 0.0006),
           ("ax", "m/s^2", 0.02), ("az", "m/s^2", 0.14), ("qdot", "rad/s^2", 0.006)]
INPUTS = [("elevator", "rad"), ("thrust", "N")]


def hello():
    return {
        "type": "hello", "source": "udp:127.0.0.1:14550", "version": "0", "flight": 0,
        "layout": {
            "model": "hfb320", "method": "smpe", "axes": ["longitudinal"],
            "parameters": [
                {"name": n, "unit": u, "initial": v, "prior_std": b / 2, "nuisance": False} for n, v, b, _, u in PARAMETERS],
            "outputs": [{"name": n, "unit": u} for n, u, _ in OUTPUTS],
            "inputs": [{"name": n, "unit": u} for n, u in INPUTS],
        },
    }


class Synthetic:
    """Documents at a sample rate, one estimate per call."""

    def __init__(self, rate_hz=100.0, seed=1):
        self.random = random.Random(seed)
        self.step = 1.0 / rate_hz
        self.k = 0

    def estimate(self):
        t = 2.0 + self.k * self.step
        self.k += 1
        pulse = (1 if t % 7 < 0.8 else -1 if t % 7 < 1.6 else 0) * 0.03
        base = [104 + 3 * math.sin(t / 15), 0.11 + 0.03 * math.sin(1.7 * t) * math.exp(-(t % 7) / 2),
                0.12 + 0.05 * math.sin(t / 6), 0.05 * math.cos(1.7 * t) * math.exp(-(t % 7) / 2),
                1.2 + 0.4 * math.sin(t / 6), -9.7 - 2 * math.sin(1.7 * t) * math.exp(-(t % 7) / 2),
                -0.08 * math.sin(1.7 * t) * math.exp(-(t % 7) / 2)]
        noise = [self.random.gauss(0, 1) for _ in OUTPUTS]
        parameters = []
        for index, (_, value, start, tau, _) in enumerate(PARAMETERS):
            sigma = start / 2 / math.sqrt(1 + (t / tau) ** 1.6) if tau < 1e8 else start / 2
            ratio = sigma / (start / 2)
            status = "not_excited" if ratio > 0.9 else "improving" if ratio > 0.2 else "converged"
            wander = math.sin(t / (3 + index)) * 0.6 + math.sin(t * 1.3 + index) * 0.2
            verdict = {"converged": "ready", "improving": "improving", "not_excited": "not_identifiable"}[status]
            if index == 10 and 40 < t < 44:
                status, verdict = "in_doubt", "doubtful"
            readiness = {
                "verdict": verdict, "reason": "the bound is %.0f %% of what was known beforehand" % (100 * ratio),
                "advice": "move the airspeed by 10 m/s" if verdict == "not_identifiable" else None,
                "ready_since_s": 12.0 if verdict == "ready" else None, "bound_over_prior": ratio, "excitation": ratio / 2,
                "variance_inflation": 4.0, "correlated_with": [],
            }
            parameters.append({"value": value + sigma * wander, "std_error": sigma, "status": status})
            # As in flight: told where it was renewed, ten times a second.
            if self.k % 10 == 1:
                parameters[-1]["readiness"] = readiness
        return {
            "type": "estimate", "time_s": round(t, 6), "phase": "sliding", "change": "in_doubt" if 40.1 < t < 43.9 else "steady",
            "moved": True, "parameters": parameters,
            "outputs": [None if i == 0 and self.k % 5 else b + n * s for i, (b, n, (_, _, s)) in enumerate(zip(base, noise, OUTPUTS))],
            "predicted": base, "residuals": [None if i == 0 and self.k % 5 else n for i, n in enumerate(noise)],
            "inputs": [pulse, 8000 + 300 * math.sin(t / 9)],
        }

    def link(self):
        return {
            "type": "link", "received": self.k * 3, "samples": self.k, "lost": self.k // 50, "late": self.k // 400, "duplicated": 0,
            "reordered": self.k // 300, "restarts": 0, "stalled": 0, "refused": 0,
            "latency_ms": {"p50": 0.21, "p99": 0.8, "p99_9": 1.9, "max": 3.2}, "recorded_bytes": self.k * 210, "waiting": None,
        }


EVENTS = [
    {"type": "event", "time_s": 12.4, "kind": "gap", "message": "nothing was received for 0.31 s; predicted through it"},
    {"type": "event", "time_s": 40.1, "kind": "in_doubt", "message": "a change of Cm_elevator is suspected; the bounds are widened"},
    {"type": "event", "time_s": 43.9, "kind": "doubt_dropped", "message": "the challenger did not win; the running estimate stays"},
]


def page():
    """The page as the program serves it: every style sheet and script inside."""
    text = (ASSETS / "index.html").read_text()
    text = re.sub(r'<link rel="stylesheet" href="([a-z]+\.css)">', lambda m: f"<style>\n{(ASSETS / m[1]).read_text()}</style>", text)
    return re.sub(r'<script src="([a-z]+\.js)"></script>', lambda m: f"<script>\n{(ASSETS / m[1]).read_text()}</script>", text)


def run(write, mode, speed=1.0, seconds=math.inf):
    """Feeds documents to `write` until it fails or `seconds` of stream time are told."""
    stream = Synthetic()
    write(hello())
    if mode == "waiting":
        for have in range(0, 10**6):
            write({**stream.link(), "waiting": "%.1f s of 2.0 s collected" % min(1.2, have / 10)})
            time.sleep(0.1)
    began, events = time.monotonic(), list(EVENTS)
    backlog = 60.0 if mode in ("backlog", "stale", "ended", "lost") else 0.0
    while True:
        document = stream.estimate()
        t = document["time_s"] - 2.0
        if t > seconds:
            break
        while events and events[0]["time_s"] <= document["time_s"]:
            write(events.pop(0))
        write(document)
        if stream.k % 100 == 0:
            write(stream.link())
        ahead = (t - backlog) / speed - (time.monotonic() - began)
        if ahead > 0.004:
            time.sleep(ahead)
        if mode == "stale" and t > backlog + 1:
            while True:
                write(stream.link())
                time.sleep(1)
        if mode == "lost" and t > backlog + 1:
            return
        if mode == "ended" and t > backlog + 1:
            break
    write({"type": "end", "reason": "the source has ended"})
    time.sleep(2)


class Server:
    """Serves the page and one kind of stream on a free port of the loopback interface."""

    def __init__(self, mode="live", speed=1.0, seconds=math.inf, text=None):
        text = (text or page()).encode()
        lost = threading.Event()

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_):
                pass

            def do_GET(self):
                if self.path.split("?")[0] == "/":
                    self.send_response(200)
                    self.send_header("Content-Type", "text/html; charset=utf-8")
                    self.send_header("Content-Length", str(len(text)))
                    self.end_headers()
                    self.wfile.write(text)
                    return
                if self.path.split("?")[0] != "/events" or lost.is_set():
                    self.send_error(503 if lost.is_set() else 404)
                    return
                self.send_response(200)
                self.send_header("Content-Type", "text/event-stream")
                self.send_header("Connection", "close")
                self.end_headers()
                self.close_connection = True

                def write(document):
                    self.wfile.write(b"data: " + json.dumps(document, separators=(",", ":")).encode() + b"\n\n")

                try:
                    run(write, mode, speed, seconds)
                except OSError:
                    pass
                if mode == "lost":
                    lost.set()

        self.http = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.http.daemon_threads = True
        self.address = f"http://127.0.0.1:{self.http.server_address[1]}/"
        threading.Thread(target=self.http.serve_forever, daemon=True).start()

    def close(self):
        self.http.shutdown()
        self.http.server_close()
