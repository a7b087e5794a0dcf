#!/usr/bin/env python3
"""Shows that a fleet on a local Ray is the fleet of this machine: with any number of workers, with workers, with whole nodes and
with the program killed (SIGKILL) at random moments of a fixed seed, with nodes added meanwhile, no row lost and none twice; and what
Ray costs.

    target/python/bin/python scripts/check-ray.py [LOGS] [KILLS] [SECONDS_OF_A_LOG]

Needs the Python package (scripts/check-python.sh) and Ray. The numbers are printed; what differs ends it with a message.
"""

from __future__ import annotations

import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

import phugoid

from killing import content, descendants, kill

MODEL = "hfb320"
#: The program that is killed: it estimates the logs into a store.
DRIVER = "import sys, phugoid; print(phugoid.fleet(sys.argv[1], sys.argv[2], sys.argv[3], engine='ray', workers=2))"


def same(store: Path, expected: dict[str, bytes], what: str) -> None:
    found = content(store)
    lost, added = expected.keys() - found.keys(), found.keys() - expected.keys()
    changed = [name for name in expected.keys() & found.keys() if expected[name] != found[name]]
    if lost or added or changed:
        sys.exit(f"{what}: {len(lost)} files lost, {len(added)} too many, {len(changed)} changed: {store}")
    print(f"{what}: the same {len(found)} files, byte for byte", flush=True)


def start(logs: Path, store: Path) -> subprocess.Popen[bytes]:
    command = [sys.executable, "-c", DRIVER, str(logs), MODEL, str(store)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def workers_killed(logs: Path, store: Path, kills: int, chance: random.Random) -> int:
    """Kills a worker at random moments while the program runs; how many were killed at work."""
    driver, killed = start(logs, store), 0
    while driver.poll() is None:
        time.sleep(chance.uniform(0.1, 0.8))
        at_work = sorted(number for number, command in descendants(driver.pid) if command.startswith("ray::_"))
        if at_work and killed < kills:
            killed += kill(chance.choice(at_work))
    if driver.returncode != 0:
        sys.exit(f"the program ended with {driver.returncode} after {killed} workers were killed")
    if killed == 0:
        sys.exit("no worker was at work when it was to be killed: take more logs")
    return killed


def program_killed(logs: Path, store: Path, kills: int, files: int, chance: random.Random) -> int:
    """Kills the program when its store has reached a random size between what it has and all that it will have, and begins it
    again, until nothing is left to do; how often it was killed."""
    killed = 0
    while True:
        driver = start(logs, store)
        # After so many kills it is left alone.
        size = chance.uniform(len(content(store)), files) if killed < kills else float("inf")
        while driver.poll() is None and len(content(store)) < size:
            time.sleep(0.05)
        if driver.poll() is None:
            killed += kill(driver.pid)
            driver.wait()
        elif driver.returncode != 0:
            sys.exit(f"the program ended with {driver.returncode} after it had been killed {killed} times")
        else:
            return killed


def nodes_changed(logs: Path, store: Path, kills: int, chance: random.Random) -> int:
    """Runs on a cluster of two nodes of one processor each. At random moments a node is added and another one is killed; how often
    that happened. The program is on a node of its own, which has no processor for tasks."""
    import ray
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
    ray.init(address=cluster.address, log_to_driver=False)
    failures: list[BaseException] = []

    def estimate() -> None:
        try:
            phugoid.fleet(str(logs), MODEL, store, engine="ray", workers=2)
        except BaseException as failure:
            failures.append(failure)

    # Nodes can be added by the main thread alone.
    estimating, changes = threading.Thread(target=estimate), 0
    estimating.start()
    while estimating.is_alive() and changes < kills:
        time.sleep(chance.uniform(0.5, 3.0))
        nodes.append(cluster.add_node(num_cpus=1))
        time.sleep(chance.uniform(0.5, 3.0))
        if estimating.is_alive():
            cluster.remove_node(nodes.pop(chance.randrange(2)), allow_graceful=False)
            changes += 1
    estimating.join()
    ray.shutdown()
    cluster.shutdown()
    if failures:
        raise failures[0]
    return changes


def write_logs(folder: Path, count: int, seconds: int) -> None:
    """Flights of the HFB-320 with another noise each."""
    scenario = folder.parent / "flight.toml"
    folder.mkdir()
    for seed in range(count):
        scenario.write_text(
            f'name = "a flight"\nduration = "{seconds} s"\nsample_rate = "25 Hz"\nseed = {seed}\n[aircraft]\nfile = "hfb320"\n'
            '[condition]\naltitude = "4300 m"\nspeed = "104.67 m/s"\n[[manoeuvre]]\ntype = "3-2-1-1"\nsurface = "elevator"\n'
            'start = "3 s"\nunit = "0.7 s"\namplitude = "0.8 deg"\n[sensors]\nalpha = { noise = "0.057 deg" }\n'
            'q = { noise = "0.033 deg/s" }\nqdot = { noise = "0.32 deg/s^2" }\n'
        )
        phugoid.simulate(str(scenario))[0].write_csv(folder / f"{seed:05}.csv")


def main() -> None:
    count, kills, seconds = (int(word) for word in (sys.argv[1:] + ["300", "6", "40"][len(sys.argv) - 1 :]))
    chance = random.Random(20)
    folder = Path(tempfile.mkdtemp(prefix="phugoid-ray-"))
    logs = folder / "logs"
    write_logs(logs, count, seconds)
    phugoid.fleet(str(logs), MODEL, folder / "local", workers=2)
    expected = content(folder / "local")
    print(f"{count} logs of {seconds} s; {len(expected)} files in the store of this machine", flush=True)

    import ray

    for workers in (2, 4, 8):
        ray.init(address="local", num_cpus=workers, log_to_driver=False, include_dashboard=False)
        phugoid.fleet(str(logs), MODEL, folder / f"ray-{workers}", engine="ray", workers=workers)
        ray.shutdown()
        same(folder / f"ray-{workers}", expected, f"{workers} workers")

    begun = time.monotonic()
    driver = start(logs, folder / "whole")
    driver.wait()
    lasts = time.monotonic() - begun
    same(folder / "whole", expected, f"a program of its own, {lasts:.1f} s with the start of Ray")
    killed = workers_killed(logs, folder / "workers", kills, chance)
    same(folder / "workers", expected, f"{killed} workers killed at work")
    changes = nodes_changed(logs, folder / "nodes", kills, chance)
    if changes == 0:
        sys.exit("no node was killed before the work was done: take more logs")
    same(folder / "nodes", expected, f"{changes} times a node added and another one killed")
    killed = program_killed(logs, folder / "program", kills, len(expected), chance)
    if killed == 0:
        sys.exit("the program was never killed: take more logs")
    same(folder / "program", expected, f"the program killed {killed} times and begun again")

    # In turns, so that what else the machine does meets both.
    ray.init(address="local", num_cpus=2, log_to_driver=False, include_dashboard=False)
    took: dict[str, list[float]] = {"local": [], "ray": []}
    for turn in range(3):
        for engine, times in took.items():
            begun = time.monotonic()
            phugoid.fleet(str(logs), MODEL, folder / f"{engine}-turn-{turn}", engine=engine, workers=2)
            times.append(time.monotonic() - begun)
    ray.shutdown()
    local, on_ray = (statistics.median(times) for times in took.values())
    print(
        f"two workers, median of three: local {local:.2f} s, Ray {on_ray:.2f} s (begun before), {100 * (on_ray / local - 1):+.0f} %;"
        f" all: {took}"
    )
    shutil.rmtree(folder)


if __name__ == "__main__":
    main()
