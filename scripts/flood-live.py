#!/usr/bin/env python3
"""Floods the port of `phugoid live` from a stranger's address while a flight is sent to it at its own pace.

The estimates have to be those of the undisturbed flight, or an event (`stranger` or `alarm`) has to come within a second
of the beginning of the flood. Usage: scripts/flood-live.py PHUGOID [SECONDS_OF_FLOOD] [FLOODING_PROCESSES]
"""

import json
import math
import multiprocessing
import socket
import subprocess
import sys
import threading
import time

RATE, FLIGHT_S = 100, 8
COLUMNS = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,ax_m_s2,elevator_rad,thrust_n,altitude_m,az_m_s2"


def rows():
    for k in range(RATE * FLIGHT_S):
        t = k / RATE
        wave = lambda mean, size: mean + size * (math.sin(2 * t + mean) + 0.02 * math.sin(977 * t + mean))
        values = [wave(205.9, 0.5), wave(0.04, 0.01), wave(0.05, 0.01), wave(0, 0.02), wave(0.3, 0.1),
                  wave(-0.03, 0.01), 9909.0, 6096.0, wave(-9.7, 0.6)]
        yield ",".join(map(repr, [t, *values])) + "\n"


def flood(address, seconds, sent):
    stranger = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    stranger.connect(address)
    end, count, datagram = time.monotonic() + seconds, 0, b"0.5,1,1,1,1,1,1,1,1,1\n"
    while time.monotonic() < end:
        for _ in range(256):
            try:
                stranger.send(datagram)
            except OSError:
                pass
        count += 256
    with sent.get_lock():
        sent.value += count


def estimates(documents):
    return [text for text in documents if text.startswith('{"type":"estimate"')]


def main():
    program = sys.argv[1]
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 3.0
    processes = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    options = ["--model", "f16", "--all", "--no-page", "--no-record"]
    flight = [COLUMNS + "\n", *rows()]
    quiet = subprocess.run([program, "live", "-", *options], input="".join(flight), text=True, capture_output=True,
                           check=True)
    expected = estimates(quiet.stdout.splitlines())

    live = subprocess.Popen([program, "live", "udp://127.0.0.1:0", *options], text=True, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL)
    hello = live.stdout.readline()
    port = int(json.loads(hello)["source"].rsplit(":", 1)[1])
    documents, first_alarm, began = [], [], []

    def read():
        for text in live.stdout:
            if began and not first_alarm and ('"kind":"stranger"' in text or '"kind":"alarm"' in text):
                first_alarm.append(time.monotonic() - began[0])
            documents.append(text.rstrip("\n"))

    reader = threading.Thread(target=read)
    reader.start()
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sent, flooding = multiprocessing.Value("Q", 0), []
    start = time.monotonic()
    for k, line in enumerate(flight):
        if k == 3 * RATE:
            began.append(time.monotonic())
            for _ in range(processes):
                flooding.append(multiprocessing.Process(target=flood, args=(("127.0.0.1", port), seconds, sent)))
                flooding[-1].start()
        time.sleep(max(0.0, start + k / RATE - time.monotonic()))
        sender.sendto(line.encode(), ("127.0.0.1", port))
    for process in flooding:
        process.join()
    time.sleep(0.5)
    live.send_signal(2)
    live.wait()
    reader.join()
    end = json.loads(documents[-1])
    same = estimates(documents) == expected
    said = f"{first_alarm[0]:.3f} s after its beginning" if first_alarm else "never"
    print(f"{sent.value / seconds:.0f} datagrams/s of strangers for {seconds} s; {end['strangers']} of them reached the "
          f"program; {end['samples']} of {RATE * FLIGHT_S} samples used; estimates "
          f"{'the same bit for bit' if same else 'not the same'}; said {said}")
    sys.exit(0 if same or (first_alarm and first_alarm[0] <= 1.0) else 1)


if __name__ == "__main__":
    main()
