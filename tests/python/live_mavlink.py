#!/usr/bin/env python3
"""Sends a simulated flight to `phugoid live` as MAVLink over UDP at 400 Hz, with losses and reordering, and checks what comes out.

    phugoid simulate f16-calm --out flight
    python tests/python/live_mavlink.py --phugoid target/release/phugoid --flight flight/measured.csv --seconds 600

Needs pymavlink (scripts/python-tools.sh). The flight, 20 s, is stretched to the time asked for by flying it forwards again and
again with time going on: what is measured here is the link, not the estimate. Checks:

* every sample whose time base was not lost on purpose gives an estimate;
* from arrival to estimate 5 ms at most at the 99.9th percentile, and less than a tenth of a core (both can be left to look at
  with --no-times, for machines that are busy with other things);
* after a kill in the middle the recording lacks 100 ms at most;
* the recording replayed gives the same estimates bit for bit.
"""
import argparse
import csv
import json
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time

from pymavlink.dialects.v20 import ardupilotmega as mavlink

# What has no message of its own goes by name, in SI.
NAMED = {"tas": "true_airspeed_m_s", "alpha": "alpha_rad", "elevator": "elevator_rad", "thrust": "thrust_n", "altitude": "altitude_m"}


def frames(rows, seconds, rate, loss, generator):
    """(time of sending s, frames) per tick; the frames that are lost on purpose are left out and counted."""
    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    ticks = int(seconds * rate)
    for tick in range(ticks):
        t = tick / rate
        row = rows[int(tick * len(rows) / (20.0 * rate)) % len(rows)]
        noise = lambda s: generator.gauss(0.0, s)
        us, ms = int(round(t * 1e6)), int(t * 1e3)
        messages = [mavlink.MAVLink_named_value_float_message(ms, name.encode(), row[column] + noise(1e-4))
                    for name, column in NAMED.items()]
        messages.append(mavlink.MAVLink_attitude_message(ms, 0.0, row["theta_rad"] + noise(1e-4), 0.0, 0.0, row["q_rad_s"], 0.0))
        # The time base last: what belongs to it is there by then.
        messages.append(mavlink.MAVLink_highres_imu_message(
            us, row["ax_m_s2"] + noise(0.02), 0.0, row["az_m_s2"] + noise(0.02), 0.0, row["q_rad_s"] + noise(1e-4), 0.0, 0, 0, 0, 0, 0, 0, 0, 0))
        packed = []
        for message in messages:
            base = message.get_msgId() == mavlink.MAVLINK_MSG_ID_HIGHRES_IMU
            data = message.pack(mav)
            mav.seq = (mav.seq + 1) % 256
            packed.append((base, data, generator.random() < loss))
        yield t, packed


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--phugoid", type=os.path.abspath, required=True)
    parser.add_argument("--flight", required=True)
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rate", type=float, default=400.0)
    parser.add_argument("--loss", type=float, default=0.02)
    parser.add_argument("--kill-at", type=float, help="kill -9 after this many seconds, and look at the recording")
    parser.add_argument("--no-times", action="store_true", help="do not fail because of latency or processor time")
    arguments = parser.parse_args()
    generator = random.Random(1)
    with open(arguments.flight) as file:
        rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]

    folder = tempfile.mkdtemp(prefix="phugoid-live-")
    recording, out = os.path.join(folder, "flight.phugoid-live"), os.path.join(folder, "live.jsonl")
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    process = subprocess.Popen([arguments.phugoid, "live", f"udp://{port}", "--model", "f16", "--record", recording, "--out", out,
                                "--all", "--listen", "0"], cwd=folder)
    time.sleep(1.0)
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sent_base, sent, dropped, killed_at, stamps = 0, 0, 0, None, []
    start, held = time.monotonic(), None
    for t, packed in frames(rows, arguments.seconds, arguments.rate, arguments.loss, generator):
        delay = start + t - time.monotonic()
        if delay > 0:
            time.sleep(delay)
        if arguments.kill_at and t >= arguments.kill_at and killed_at is None:
            process.send_signal(signal.SIGKILL)
            killed_at = t
            break
        for base, data, lost in packed:
            if lost:
                dropped += 1
                continue
            # One in a hundred is overtaken by the next.
            if held is None and generator.random() < 0.01:
                held = (base, data)
                continue
            sender.sendto(data, ("127.0.0.1", port))
            if held is not None:
                sender.sendto(held[1], ("127.0.0.1", port))
                sent_base += held[0]
                sent += 1
                held = None
            sent_base += base
            sent += 1
    failures = []
    if killed_at is not None:
        process.wait()
        replayed = replay(arguments.phugoid, recording, folder)
        last = max(d["arrival_s"] for d in replayed if d["type"] == "event" or d["type"] == "link")
        times = [d["time_s"] for d in replayed if d["type"] == "estimate"]
        lost_ms = 1e3 * (killed_at - times[-1])
        print(f"killed at {killed_at:.3f} s of the sender's time; the recording reaches {times[-1]:.3f} s: {lost_ms:.0f} ms lost ({last:.1f} s)")
        if lost_ms > 100:
            failures.append(f"{lost_ms:.0f} ms of the recording are lost, more than 100 ms")
    else:
        time.sleep(1.0)
        with open(f"/proc/{process.pid}/stat") as file:
            fields = file.read().rsplit(")", 1)[1].split()
        cpu_s = (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
        process.send_signal(signal.SIGINT)
        process.wait(timeout=30)
        lines = open(out).read().splitlines()
        documents = [json.loads(line) for line in lines]
        end = documents[-1]
        share = cpu_s / arguments.seconds
        estimates = [d for d in documents if d["type"] == "estimate"]
        print(f"sent {sent} frames ({dropped} more lost on purpose), {sent_base} of the time base; received {end['received']}, "
              f"counted lost {end['lost']}, reordered {end['reordered']}, duplicated {end['duplicated']}, late {end['late']}")
        print(f"samples {end['samples']}, estimates {end['estimates']}, published {len(estimates)}; latency ms {end['latency_ms']}")
        lengths = [len(line) for line, d in zip(lines, documents) if d["type"] == "estimate"]
        print(f"an estimate has {sum(lengths) / len(lengths):.0f} bytes in the mean, {max(lengths)} at most")
        print(f"processor time {cpu_s:.2f} s of {arguments.seconds:.0f} s: {100 * share:.1f} % of a core; recording {os.path.getsize(recording)} bytes")
        if end["received"] != sent:
            failures.append(f"{sent - end['received']} frames that were sent were not received")
        if end["samples"] != sent_base:
            failures.append(f"{sent_base - end['samples']} samples were lost on the way to the estimation")
        # Those of the first two seconds, from which noise and reference are taken, come together as one.
        if not 0 <= end["samples"] - len(estimates) <= 2.1 * arguments.rate or len(estimates) != end["estimates"]:
            failures.append("estimates are missing")
        if not arguments.no_times and end["latency_ms"]["p99_9"] > 5.0:
            failures.append(f"the latency is {end['latency_ms']['p99_9']:.2f} ms at the 99.9th percentile")
        if not arguments.no_times and share > 0.1:
            failures.append(f"{100 * share:.1f} % of a core")
        again = [d for d in replay(arguments.phugoid, recording, folder) if d["type"] == "estimate"]
        if again != estimates:
            failures.append("the replayed recording gives other estimates")
        print(f"replayed: {len(again)} estimates, {'the same' if again == estimates else 'others'}")
    for failure in failures:
        print("FAILED:", failure)
    sys.exit(bool(failures))


def replay(phugoid, recording, folder):
    out = subprocess.run([phugoid, "live", "--replay", recording, "--speed", "max", "--all", "--no-page"], cwd=folder, check=True, capture_output=True)
    return [json.loads(line) for line in out.stdout.splitlines()]


if __name__ == "__main__":
    main()
