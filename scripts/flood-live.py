#!/usr/bin/env python3
"""Attacks `phugoid live` on this machine while a flight is sent to it at its own pace, and measures what that does.

  scripts/flood-live.py PHUGOID [SECONDS] [FLOODING_PROCESSES]      10 s and 2 processes if they are not given

Each attack has a program of its own, with its page and its recording; the first one is left in peace, to know what the
machine gives by itself. All traffic stays on the loopback interface, and every attack ends by itself.

  peace    nothing
  flood    datagrams from other ports, as fast as the processes can: other values, times that lead by 50 s, no rows
  page     64 connections that send nothing, 64 that ask for the events and take none, 2000 that are closed at once; and
           meanwhile a new reader every half a second
  both     the two at one time

It fails (exit code 1) if the estimates are not those of the same rows read from a pipe, bit for bit, and no event
(`stranger` or `alarm`) says so within a second; if the memory grows by more than the bounds of docs/live.md; if a new
reader is not served at all; or if a replay of the recording gives other estimates. Times are printed beside what is
asked of a quiet machine, and never make it fail: on a busy one they are those of the machine.
"""

import http.client
import json
import math
import multiprocessing
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time

RATE, BEFORE_S, AFTER_S = 100, 3, 2
COLUMNS = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,ax_m_s2,elevator_rad,thrust_n,altitude_m,az_m_s2"
# What may wait: arrivals for the estimation and for the recording (docs/live.md). Beside them sixteen documents of each
# of 128 connections, and what the allocator keeps.
MOST_MB = 16 + 64 + 20
SILENT, STUCK, SHORT = 64, 64, 2000
# What is asked of a quiet machine.
ASKED_RATE, ASKED_MS, ASKED_SERVED_S = 250_000, 5, 2
# A reader that is not served by then is not served at all, s.
PATIENCE_S = 30


def rows(seconds):
    for k in range(RATE * seconds):
        t = k / RATE
        wave = lambda mean, size: mean + size * (math.sin(2 * t + mean) + 0.02 * math.sin(977 * t + mean))
        values = [wave(205.9, 0.5), wave(0.04, 0.01), wave(0.05, 0.01), wave(0, 0.02), wave(0.3, 0.1),
                  wave(-0.03, 0.01), 9909.0, 6096.0, wave(-9.7, 0.6)]
        yield ",".join(map(repr, [t, *values])) + "\n"


def flood(address, seconds, sent):
    """Sends for so many seconds, each kind of datagram in turn."""
    stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    stranger.connect(address)
    end, count = time.monotonic() + seconds, 0
    began = time.monotonic()
    while time.monotonic() < end:
        now_s = BEFORE_S + time.monotonic() - began
        kinds = [f"{now_s:.3f},1,1,1,1,1,1,1,1,1\n".encode(), f"{now_s + 50:.3f},205.9,0,0,0,0,0,9909,6096,-9.7\n".encode(),
                 COLUMNS.encode() + b"\n", b"\xfd" + bytes(30)]
        for _ in range(128):
            for datagram in kinds:
                try:
                    stranger.send(datagram)
                    count += 1
                except OSError:
                    pass
    with sent.get_lock():
        sent.value += count


class Page:
    """Attacks the page at (host, port) for so many seconds."""

    def __init__(self, address, seconds):
        self.address, self.seconds, self.served, self.failed, self.short = address, seconds, [], [], 0
        self.threads = [threading.Thread(target=work) for work in (self.attack, self.read)]
        for thread in self.threads:
            thread.start()

    def connect(self):
        return socket.create_connection(self.address, timeout=PATIENCE_S)

    def attack(self):
        held, end = [], time.monotonic() + self.seconds
        for k in range(max(SILENT, STUCK)):
            if k < SILENT:
                held.append(self.connect())
            if k < STUCK:
                held.append(self.connect())
                held[-1].sendall(f"GET /events HTTP/1.1\r\nHost: {self.address[0]}:{self.address[1]}\r\n\r\n".encode())
        for k in range(SHORT):
            try:
                self.connect().close()
                self.short += 1
            except OSError:
                pass
            time.sleep(max(0.0, (end - time.monotonic()) / (SHORT - k)))
        for connection in held:
            connection.close()

    def read(self):
        end = time.monotonic() + self.seconds
        time.sleep(0.5)
        while time.monotonic() < end:
            began = time.monotonic()
            try:
                connection = http.client.HTTPConnection(*self.address, timeout=PATIENCE_S)
                connection.request("GET", "/result.json")
                answer = connection.getresponse()
                json.loads(answer.read())
                if answer.status != 200:
                    raise OSError(f"status {answer.status}")
                self.served.append(time.monotonic() - began)
            except (OSError, ValueError, http.client.HTTPException) as error:
                self.failed.append(f"{error!r} after {time.monotonic() - began:.2f} s")
            time.sleep(0.5)

    def join(self):
        for thread in self.threads:
            thread.join()


def memory_mb(process, field):
    with open(f"/proc/{process}/status") as status:
        return next(int(line.split()[1]) for line in status if line.startswith(field)) / 1024


def estimates(documents):
    return [text for text in documents if text.startswith('{"type":"estimate"')]


def run(program, name, seconds, processes, expected, folder):
    """One flight under one attack. Gives the sentences of what was wrong."""
    recording = os.path.join(folder, f"{name}.phugoid-live")
    live = subprocess.Popen([program, "live", "udp://127.0.0.1:0", "--model", "f16", "--all", "--listen", "127.0.0.1:0",
                             "--record", recording], text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    try:
        port = int(json.loads(live.stdout.readline())["source"].rsplit(":", 1)[1])
        page = next(line for line in live.stderr if line.startswith("page: "))
        host, page_port = page.split("//")[1].split("/")[0].rsplit(":", 1)
        documents, said, began = [], [], []

        def read():
            for text in live.stdout:
                if began and not said and ('"kind":"stranger"' in text or '"kind":"alarm"' in text):
                    said.append(time.monotonic() - began[0])
                documents.append(text.rstrip("\n"))

        reader = threading.Thread(target=read)
        reader.start()
        threading.Thread(target=live.stderr.read).start()
        sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        sent, flooding, attacked = multiprocessing.Value("Q", 0), [], None
        start, late = time.monotonic(), 0.0
        for k, line in enumerate([COLUMNS + "\n", *rows(BEFORE_S + seconds + AFTER_S)]):
            if k == BEFORE_S * RATE:
                before_mb = memory_mb(live.pid, "VmRSS")
                began.append(time.monotonic())
                if name in ("flood", "both"):
                    for _ in range(processes):
                        flooding.append(multiprocessing.Process(target=flood, args=(("127.0.0.1", port), seconds, sent)))
                        flooding[-1].start()
                if name in ("page", "both"):
                    attacked = Page((host, int(page_port)), seconds)
            time.sleep(max(0.0, start + k / RATE - time.monotonic()))
            late = max(late, time.monotonic() - start - k / RATE)
            sender.sendto(line.encode(), ("127.0.0.1", port))
        for process in flooding:
            process.join()
        if attacked:
            attacked.join()
        time.sleep(0.5)
        peak_mb = memory_mb(live.pid, "VmHWM")
        live.send_signal(2)
        live.wait(60)
        reader.join()
    finally:
        live.kill()
    end, found, wrong = json.loads(documents[-1]), estimates(documents), []
    same = found == expected
    latency = end["latency_ms"]
    print(f"{name}:")
    print(f"  {end['samples']} samples and {len(found)} estimates, {'the same as' if same else 'NOT the same as'} those of a "
          f"pipe, bit for bit")
    if flooding:
        when = f"{1e3 * said[0]:.0f} ms after its beginning" if said else "never"
        print(f"  {sent.value / seconds:.0f} datagrams/s of strangers for {seconds} s (asked {ASKED_RATE} and more); "
              f"{end['strangers']} of them reached the program; said {when} (asked 1 s)")
    if not same and not (said and said[0] <= 1.0):
        wrong.append("the estimates differ, and no event says why within a second")
    if attacked:
        slowest = f"{1e3 * max(attacked.served):.0f} ms" if attacked.served else "never"
        print(f"  {SILENT} silent, {STUCK} that take nothing, {attacked.short} short connections; {len(attacked.served)} new "
              f"readers, the slowest served after {slowest} (asked {ASKED_SERVED_S} s)")
        wrong += [f"a new reader was not served: {failure}" for failure in attacked.failed]
        if not attacked.served:
            wrong.append("no new reader was served")
    print(f"  memory {before_mb:.0f} MB before, at most {peak_mb:.0f} MB (may grow by {MOST_MB} MB)")
    if peak_mb - before_mb > MOST_MB:
        wrong.append(f"the memory grew by {peak_mb - before_mb:.0f} MB")
    print(f"  latency p50 {latency['p50']:.2f}, p99 {latency['p99']:.2f}, p99.9 {latency['p99_9']:.2f} (asked {ASKED_MS}), "
          f"max {latency['max']:.2f} ms; the sender itself was late by up to {1e3 * late:.0f} ms")
    replayed = subprocess.run([program, "live", "--replay", recording, "--speed", "max", "--all", "--no-page"], text=True,
                              capture_output=True, check=True)
    if estimates(replayed.stdout.splitlines()) != found:
        wrong.append("a replay of the recording gives other estimates")
    return [f"{name}: {what}" for what in wrong]


def main():
    program = os.path.abspath(sys.argv[1])
    seconds = int(sys.argv[2]) if len(sys.argv) > 2 else 10
    processes = int(sys.argv[3]) if len(sys.argv) > 3 else 2
    flight = COLUMNS + "\n" + "".join(rows(BEFORE_S + seconds + AFTER_S))
    quiet = subprocess.run([program, "live", "-", "--model", "f16", "--all", "--no-page", "--no-record"], input=flight,
                           text=True, capture_output=True, check=True)
    expected, wrong = estimates(quiet.stdout.splitlines()), []
    print(f"{os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}; {len(expected)} estimates expected")
    with tempfile.TemporaryDirectory() as folder:
        for name in ("peace", "flood", "page", "both"):
            wrong += run(program, name, seconds, processes, expected, folder)
    for what in wrong:
        print(f"WRONG: {what}")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
