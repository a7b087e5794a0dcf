#!/usr/bin/env python3
"""Shows that a study whose runs are made by shards on a local Ray is the study of this machine: undisturbed, with the programs of
shards killed (SIGKILL) at random moments of a fixed seed, and with the program itself killed and begun again.

    target/python/bin/python scripts/check-ray-studies.py PROGRAM [RUNS] [KILLS]

PROGRAM is a `phugoid` with stores (--features fleet). Needs the Python package (scripts/check-python.sh) and Ray. What differs ends
it with a message.
"""

from __future__ import annotations

import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from killing import content, descendants, kill


def shards(driver: int) -> list[int]:
    """The programs of shards that a program has begun, by tasks of Ray."""
    return sorted(number for number, command in descendants(driver) if " --shard " in command)


def main() -> None:
    program, runs, kills = (sys.argv[1:] + ["60", "6"][len(sys.argv) - 2 :])[:3]
    chance = random.Random(21)
    folder = Path(tempfile.mkdtemp(prefix="phugoid-ray-studies-"))
    study = [program, "study", "accuracy", "--scenario", "f16-calm", "--model", "f16-model", "--method", "rls", "--runs", runs, "--json"]

    def asked(store: Path) -> list[str]:
        return [*study, "--store", str(store), "--engine", "ray"]

    environment = {**os.environ, "PHUGOID_PYTHON": sys.executable}
    begun = time.monotonic()
    without = subprocess.run(study, check=True, capture_output=True).stdout
    alone = time.monotonic() - begun
    begun = time.monotonic()
    on_ray = subprocess.run(asked(folder / "whole"), check=True, capture_output=True, env=environment).stdout
    print(f"{runs} runs: {alone:.1f} s by threads, {time.monotonic() - begun:.1f} s by Ray with its start", flush=True)
    if on_ray != without:
        sys.exit(f"the result by Ray is another one: {folder}")
    expected = content(folder / "whole")

    driver = subprocess.Popen(asked(folder / "shards"), stdout=subprocess.PIPE, env=environment)
    killed = 0
    while driver.poll() is None:
        time.sleep(chance.uniform(0.2, 1.0))
        at_work = shards(driver.pid)
        if at_work and killed < int(kills):
            killed += kill(chance.choice(at_work))
    out, _ = driver.communicate()
    if driver.returncode != 0 or out != without or content(folder / "shards") != expected or killed == 0:
        sys.exit(f"after {killed} kills of shards: exit {driver.returncode}, other result or store: {folder}")
    print(f"{killed} shards killed: the same result and store", flush=True)

    killed = 0
    while True:
        driver = subprocess.Popen(asked(folder / "program"), stdout=subprocess.PIPE, env=environment)
        size = chance.uniform(len(content(folder / "program")), len(expected)) if killed < int(kills) else float("inf")
        while driver.poll() is None and len(content(folder / "program")) < size:
            time.sleep(0.05)
        if driver.poll() is None:
            killed += kill(driver.pid)
            driver.communicate()
            continue
        out, _ = driver.communicate()
        break
    if driver.returncode != 0 or out != without or content(folder / "program") != expected or killed == 0:
        sys.exit(f"after {killed} kills of the program: exit {driver.returncode}, other result or store: {folder}")
    print(f"the program killed {killed} times and begun again: the same result and store", flush=True)
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
