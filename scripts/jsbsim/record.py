#!/usr/bin/env python3
"""Lets JSBSim fly aircraft with moving controls, and records every property of every step: what the reader of its aircraft is
compared with.

    scripts/jsbsim/record.py FOLDER [AIRCRAFT ...]

Needs the package jsbsim (scripts/python-tools.sh). Writes FOLDER/AIRCRAFT.csv.gz, with engines at rest, and
FOLDER/AIRCRAFT.engines.csv.gz, 30 s with engines that run at 0.7 of their throttle and hands off. The first line names the properties; those
that never change stand there as NAME=VALUE and have no column. The first row is the state after the initial condition.
command/NAME is what a control was set to before the step, which flight control may have overwritten at its end.
"""

import gzip
import math
import multiprocessing
import os
import shutil
import sys
import tempfile

RATE_HZ = 120
STEPS = 600
PARTS = "parts"
TESTS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../crates/phugoid-aircraft/tests/integration/jsbsim")
# Kept for a last check: recorded only where they are named.
RESERVED = {"c172p", "737", "f16", "SGS", "minisgs", "Concorde"}


def commands(time):
    """Controls at a time, s, by the names of their properties."""
    step = lambda at: 1.0 if time >= at else 0.0
    return {
        "fcs/elevator-cmd-norm": 0.4 * math.sin(2.0 * time),
        "fcs/aileron-cmd-norm": 0.5 * math.sin(3.1 * time + 0.3),
        "fcs/rudder-cmd-norm": 0.3 * math.sin(1.3 * time) - 0.2 * step(2.0),
        "fcs/pitch-trim-cmd-norm": 0.1 * step(1.5),
        "fcs/roll-trim-cmd-norm": -0.05 * step(1.0),
        "fcs/yaw-trim-cmd-norm": 0.07 * step(0.5),
        "fcs/flap-cmd-norm": 0.6 * step(1.0) - 0.3 * step(3.0),
        "fcs/speedbrake-cmd-norm": step(2.0) - step(3.0),
        "fcs/spoiler-cmd-norm": 0.5 * step(2.5),
        "gear/gear-cmd-norm": 1.0 - step(0.5) + step(4.0),
        "fcs/throttle-cmd-norm": 0.5 + 0.4 * math.sin(time),
        "fcs/mixture-cmd-norm": 0.9,
        "fcs/steer-cmd-norm": 0.2 * math.sin(time),
        "fcs/left-brake-cmd-norm": 0.3 * step(1.0),
        "fcs/right-brake-cmd-norm": 0.4 * step(1.2),
    }


def record(folder, name, running):
    """One aircraft; gives a line that says what came of it."""
    import jsbsim

    devnull = os.open(os.devnull, os.O_WRONLY)
    os.dup2(devnull, 1)
    os.dup2(devnull, 2)
    jsbsim.FGJSBBase().debug_lvl = 0
    flight = jsbsim.FGFDMExec(None)
    flight.set_debug_level(0)
    flight.disable_output()
    flight.set_dt(1.0 / RATE_HZ)
    if name == PARTS:
        # An aircraft of ours with every component and function: JSBSim looks for it in a folder of its name.
        place = os.path.join(folder, "aircraft", name)
        os.makedirs(place, exist_ok=True)
        shutil.copy(os.path.join(TESTS, f"{name}.xml"), place)
        flight.set_aircraft_path(os.path.abspath(os.path.join(folder, "aircraft")))
    flight.load_model(name)
    for key, value in {"h-sl-ft": 8000, "vt-kts": 220, "alpha-deg": 3, "beta-deg": 1, "phi-deg": 5, "theta-deg": 4, "psi-true-deg": 30}.items():
        flight[f"ic/{key}"] = value
    flight.run_ic()
    names = sorted({line.split(" (")[0].strip() for line in flight.query_property_catalog("").split("\n")} - {""})
    known = set(names)
    set_names = [key for key in commands(0.0) if key in known]
    if running:
        set_names = []
        for key, value in {"propulsion/set-running": -1, "propulsion/magneto_cmd": 3}.items():
            flight[key] = value
        for found in names:
            for start, value in {"fcs/throttle-cmd-norm": 0.7, "fcs/mixture-cmd-norm": 0.87, "fcs/advance-cmd-norm": 1.0}.items():
                if found.startswith(start):
                    flight[found] = value
    rows = []

    def take(settings):
        rows.append([flight.get_property_value(found) for found in names] + settings)

    take([flight.get_property_value(key) for key in set_names])
    try:
        for k in range(1, (6 if running else 1) * STEPS + 1):
            wanted = commands(k / RATE_HZ)
            for key in set_names:
                flight[key] = wanted[key]
            if not flight.run():
                break
            if not running or k % 60 == 0:
                take([wanted[key] for key in set_names])
            if not math.isfinite(flight["velocities/vt-fps"]):
                rows.pop()
                break
    except Exception as error:  # noqa: BLE001  JSBSim raises whatever its aircraft cannot bear.
        problem = f", then {error}"
    else:
        problem = ""
    names += [f"command/{key}" for key in set_names]
    constant = [len({repr(row[k]) for row in rows}) == 1 for k in range(len(names))]
    header = [f"{found}={rows[0][k]!r}" if constant[k] else found for k, found in enumerate(names)]
    with gzip.open(os.path.join(folder, f"{name}{'.engines' if running else ''}.csv.gz"), "wt", compresslevel=1) as out:
        out.write(",".join(header) + "\n")
        for row in rows:
            out.write(",".join(repr(value) for k, value in enumerate(row) if not constant[k]) + "\n")
    return f"{name}: {len(rows)} rows{problem}"


def main():
    import jsbsim

    folder = os.path.abspath(sys.argv[1])
    os.makedirs(folder, exist_ok=True)
    # Some aircraft write files of their own into the current folder.
    scratch = tempfile.TemporaryDirectory()
    os.chdir(scratch.name)
    aircraft = os.path.join(jsbsim.get_default_root_dir(), "aircraft")
    names = sys.argv[2:] or sorted(
        name for name in os.listdir(aircraft) if os.path.isfile(os.path.join(aircraft, name, f"{name}.xml"))
    )
    names += [] if sys.argv[2:] else [PARTS]
    # Each in a process of its own: JSBSim may end the process of an aircraft that it refuses.
    for name in names:
        if name in RESERVED and not sys.argv[2:]:
            continue
        for running in (False, True):
            pool = multiprocessing.get_context("spawn").Pool(1)
            try:
                print(pool.apply_async(record, (folder, name, running)).get(timeout=120), flush=True)
            except Exception as error:  # noqa: BLE001
                print(f"{name}: none: {error!r}"[:200], flush=True)
            pool.terminate()


if __name__ == "__main__":
    main()
