"""What the round trips share: our reader as a program, the shared data, and the comparison of numbers."""

import json
import math
import os
import pathlib
import subprocess

EXAMPLES = pathlib.Path(os.environ["PHUGOID_EXAMPLES"])


def shared(name):
    """A file of the shared data; None where it is absent, unless CI is set, where that is a failure."""
    path = pathlib.Path(os.environ["PHUGOID_SHARED_DATA"]) / name
    if path.is_file():
        return path
    assert not os.environ.get("CI"), f"{path} is not there"
    print(f"  skipped: {path} is not there")
    return None


def dump_log(path):
    """Our reading of a log: its head, and its topics by (name, instance)."""
    run = subprocess.run([EXAMPLES / "dump_log", path], capture_output=True, check=True, text=True)
    lines = run.stdout.splitlines()
    head = json.loads(lines[0])
    topics = {}
    for line in lines[1:]:
        topic = json.loads(line)
        topics[topic["name"], topic["instance"]] = topic
    return head, topics


def same(ours, theirs, tolerance=0.0):
    """Equal as numbers; null is our NaN (JSON has no infinity either)."""
    if ours is None:
        return not math.isfinite(theirs)
    return abs(ours - theirs) <= tolerance * max(1.0, abs(theirs))


def compare(place, ours, theirs, tolerance=0.0):
    """Both series have the same numbers."""
    assert len(ours) == len(theirs), f"{place}: {len(ours)} values, {len(theirs)} expected"
    for index, (a, b) in enumerate(zip(ours, theirs)):
        assert same(a, float(b), tolerance), f"{place}, sample {index}: {a!r}, expected {b!r}"
    return len(ours)
