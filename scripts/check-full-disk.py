#!/usr/bin/env python3
"""Records a flight on a disk that is full for four seconds or more in its middle, and on one with a limit of size.

  scripts/check-full-disk.py PHUGOID

The disks are file systems in memory (tmpfs), mounted where this process alone sees them; they are gone with it, however
it ends. Where the system does not allow that, it says so and ends with 0. It fails if something is lost and not said,
if anything is lost that came after there was room again, or if a limit of size is not kept.

  short    what comes in four seconds finds room in memory (64 MB): nothing is lost
  much     so much comes that memory is not enough: what is lost is said, to the packet, and noted where it is missing
  limit    --record-limit: parts, of which the oldest go; together they never have more than the limit
"""

import glob
import json
import math
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time

RATE, FULL_S, BEFORE_S, AFTER_S = 100, 4, 3, 3
COLUMNS = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,ax_m_s2,elevator_rad,thrust_n,altitude_m,az_m_s2"
INSIDE = "PHUGOID_FULL_DISK_INSIDE"
# The greatest datagram that loopback takes whole, as a comment between the rows.
FILLER = b"#" + b"x" * 60_000


def own_mounts():
    """Starts this script again where its mounts are its own; ends here if the system does not allow that."""
    wrapper = ["unshare", "--mount", "--propagation", "private"]
    if os.geteuid() != 0:
        wrapper += ["--user", "--map-root-user"]
    with tempfile.TemporaryDirectory() as folder:
        try:
            tried = subprocess.run([*wrapper, "mount", "-t", "tmpfs", "-o", "size=1m", "tmpfs", folder], capture_output=True)
            reason = tried.stderr.decode().strip() if tried.returncode else None
        except OSError as error:
            reason = str(error)
    if reason:
        print(f"full disk: not checked, because no file system in memory can be mounted here ({reason})")
        sys.exit(0)
    environment = {**os.environ, INSIDE: "1"}
    sys.exit(subprocess.run([*wrapper, sys.executable, __file__, *sys.argv[1:]], env=environment).returncode)


def row(k):
    t = k / RATE
    wave = lambda mean, size: mean + size * (math.sin(2 * t + mean) + 0.02 * math.sin(977 * t + mean))
    values = [wave(205.9, 0.5), wave(0.04, 0.01), wave(0.05, 0.01), wave(0, 0.02), wave(0.3, 0.1), wave(-0.03, 0.01),
              9909.0, 6096.0, wave(-9.7, 0.6)]
    return (",".join(map(repr, [t, *values])) + "\n").encode()


def fill(folder):
    """Takes what room there is on the disk, to the last byte. Gives the file that has it."""
    path = os.path.join(folder, "ballast")
    with open(path, "ab", buffering=0) as ballast:
        for size in (1 << 16, 1 << 12, 1):
            try:
                while True:
                    ballast.write(b"\0" * size)
            except OSError:
                pass
    return path


def events(documents, kind):
    return [d["message"] for d in documents if d["type"] == "event" and d["kind"] == kind]


def estimates(text):
    return [line for line in text.splitlines() if line.startswith('{"type":"estimate"')]


class Flight:
    """A flight that is received, recorded on a disk of so many MB, and replayed."""

    def __init__(self, program, name, megabytes, fillers, full, more):
        self.program, self.name, self.wrong = program, name, []
        self.folder = tempfile.mkdtemp(prefix=f"phugoid-full-disk-{name}-")
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={megabytes}m", "tmpfs", self.folder], check=True)
        try:
            self.fly(fillers, full, more)
        finally:
            subprocess.run(["umount", self.folder])
            os.rmdir(self.folder)

    def recordings(self):
        number = lambda path: int((re.findall(r"\.(\d+)\.phugoid-live$", path) or [1])[0])
        return sorted(glob.glob(os.path.join(self.folder, "*.phugoid-live")), key=number)

    def fly(self, fillers, full, more):
        recording = os.path.join(self.folder, "flight.phugoid-live")
        live = subprocess.Popen([self.program, "live", "udp://127.0.0.1:0", "--model", "f16", "--all", "--no-page",
                                 "--record", recording, *more], text=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
        lines = []
        try:
            hello = live.stdout.readline()
            port = int(json.loads(hello)["source"].rsplit(":", 1)[1])
            reader = threading.Thread(target=lambda: lines.extend(live.stdout))
            reader.start()
            sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            sender.connect(("127.0.0.1", port))
            sender.send(COLUMNS.encode() + b"\n")
            start, ballast, self.most, k, last = time.monotonic(), None, 0, 0, RATE * (BEFORE_S + FULL_S + AFTER_S)
            while k < last or ballast:
                if full and k == RATE * BEFORE_S:
                    ballast = fill(self.folder)
                # Where packets are to be lost: until some are, however slow the machine is, but not for ever.
                enough = not fillers or any('"type":"link"' in line and '"recording_dropped":0' not in line for line in lines[-300:])
                if ballast and k >= RATE * (BEFORE_S + FULL_S) and (enough or k >= RATE * 60):
                    os.remove(ballast)
                    ballast, self.free_s, last = None, k / RATE, k + RATE * AFTER_S
                time.sleep(max(0.0, start + k / RATE - time.monotonic()))
                sender.send(row(k))
                # Many at one time find no room in the buffer of the system, which is another loss than that of a disk.
                for _ in range(fillers if ballast or not full else 0):
                    sender.send(FILLER)
                k += 1
                self.most = max(self.most, sum(os.path.getsize(path) for path in self.recordings() if os.path.exists(path)))
            time.sleep(1.0)
            live.send_signal(2)
            code = live.wait(60)
            reader.join()
        finally:
            live.kill()
        if code != 0:
            self.wrong.append(f"it ended with {code}")
        self.documents = [json.loads(line) for line in [hello, *lines]]
        self.estimates = estimates("".join(lines))
        self.news = events(self.documents, "recording")
        self.dropped = [d for d in self.documents if d["type"] == "link"][-1]["recording_dropped"]
        self.parts = self.recordings()
        self.replays = [self.replay(path) for path in self.parts]

    def replay(self, path):
        run = subprocess.run([self.program, "live", "--replay", path, "--speed", "max", "--all", "--no-page"], text=True,
                             capture_output=True)
        return run.stdout

    def ask(self, that, otherwise):
        if not that:
            self.wrong.append(otherwise)

    def told_and_resumed(self):
        """The disk was full, that was said, and what was lost is said as it is."""
        self.ask(any("cannot be written" in news and "No space" in news for news in self.news), "the full disk was not said")
        resumed = [news for news in self.news if "goes on after" in news]
        self.ask(resumed, "that the recording goes on was not said")
        return resumed

    def report(self, what):
        print(f"{self.name}: {what}")
        for news in self.news[:3]:
            print(f"  said: {news}")
        if len(self.news) > 3:
            print(f"  and {len(self.news) - 3} more of this kind")
        for wrong in self.wrong:
            print(f"  WRONG: {wrong}")
        return not self.wrong


def times(text):
    return [json.loads(line)["time_s"] for line in estimates(text)]


def short(program):
    flight = Flight(program, "short", 1, 0, True, [])
    resumed = flight.told_and_resumed()
    flight.ask(all("nothing was lost" in news for news in resumed) and flight.dropped == 0, "something was lost")
    flight.ask(estimates(flight.replays[0]) == flight.estimates, "a replay gives other estimates")
    return flight.report(f"full for {FULL_S} s; {len(flight.estimates)} estimates, the same in a replay")


def much(program):
    flight = Flight(program, "much", 160, 6, True, [])
    flight.told_and_resumed()
    replay = flight.replays[0]
    # All that is said to be missing is what is missing, and the file says so too.
    said = sum(int(n) for news in flight.news for n in re.findall(r"(\d+) packets are missing", news))
    noted = [int(n) for n in re.findall(r"(\d+) packets were not recorded", replay)]
    flight.ask(flight.dropped > 0, "nothing was lost: the check checks too little")
    flight.ask(said == flight.dropped and noted == [flight.dropped],
               f"{flight.dropped} packets were lost, {said} were said and {noted} are noted in the recording")
    lived, replayed = times("\n".join(flight.estimates)), times(replay)
    missing = sorted(set(lived) - set(replayed))
    flight.ask(set(replayed) <= set(lived), "a replay has samples that the flight has not")
    last_said = max(i for i, d in enumerate(flight.documents) if d["type"] == "event" and d["kind"] == "recording")
    later = [d["time_s"] for d in flight.documents[last_said:] if d["type"] == "estimate" and d["time_s"] in set(missing)]
    flight.ask(not later, f"samples are missing that came after it was said that the recording goes on: {later[:5]}")
    flight.ask(replayed and replayed[-1] == lived[-1], "the end is missing")
    flight.ask(not [time_s for time_s in missing if time_s < BEFORE_S], "samples are missing that came before")
    span = f"{missing[0]:.2f} to {missing[-1]:.2f} s" if missing else "none"
    return flight.report(f"full for {flight.free_s - BEFORE_S:.0f} s; {flight.dropped} packets lost, and said; samples without a place in the recording: {span}")


def limit(program):
    most = 4_000_000
    flight = Flight(program, "limit", 16, 1, False, ["--record-limit", f"{most // 1_000_000}MB"])
    flight.ask(len(flight.parts) == 4, f"{len(flight.parts)} parts")
    # Each of four parts ends with the write that makes it long enough: a sixteenth of a part and one datagram more.
    slack = most // 16 + 4 * 70_000
    flight.ask(flight.most <= most + slack, f"the parts had {flight.most} bytes at one time")
    flight.ask(any("was removed" in news for news in flight.news), "that a part was removed was not said")
    for path, replay in zip(flight.parts, flight.replays):
        flight.ask(json.loads(replay.splitlines()[-1])["samples"] > 0, f"{path} gives no sample alone")
    return flight.report(f"{len(flight.parts)} parts, at most {flight.most} bytes at one time")


def main():
    if INSIDE not in os.environ:
        own_mounts()
    program = os.path.abspath(sys.argv[1])
    good = [check(program) for check in (short, much, limit)]
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
