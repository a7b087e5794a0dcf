#!/usr/bin/env python3
"""Measures how fast JSBSim flies aircraft and how fast the example flown_speed does, in turns, and prints both.

    scripts/jsbsim/speed.py FLOWN_SPEED [AIRCRAFT ...]

Needs the package jsbsim (scripts/python-tools.sh). JSBSim makes one evaluation in each step of 1/120 s; its flight control, its
engines, its atmosphere and the contact of the gear with the ground run in each step too. Of its time the loop in Python is a
part, which is measured with a call that does nothing and taken off. Its error of the step is the largest difference of the
angles of attack, sideslip, bank and pitch in ten seconds from a flight with sixteen times as many steps; ours, with the same
angles over the same time, may not be larger. Times are processor times of the fastest of several pieces.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
import time

RATE_HZ = 120
FINE = 16
DURATION_S = 10.0
SAMPLE_S = 0.5
PIECES = 7
PIECE_STEPS = 6000
# Speed, m/s, and altitude, m.
CONDITIONS = {"c182": (61.7, 1524.0), "f15": (200.0, 3000.0)}
ANGLES = ["aero/alpha-rad", "aero/beta-rad", "attitude/phi-rad", "attitude/theta-rad"]
FOOT = 0.3048


def begun(name, parts):
    """JSBSim at the beginning of the flight: in trim, then out of it in all angles."""
    import jsbsim

    jsbsim.FGJSBBase().debug_lvl = 0
    flight = jsbsim.FGFDMExec(None)
    flight.set_debug_level(0)
    flight.disable_output()
    flight.set_dt(1.0 / RATE_HZ / parts)
    flight.load_model(name)
    speed, altitude = CONDITIONS[name]
    conditions = {"h-sl-ft": altitude / FOOT, "vt-fps": speed / FOOT, "alpha-deg": 2.0, "theta-deg": 2.0}
    for key, value in conditions.items():
        flight[f"ic/{key}"] = value
    flight["gear/gear-cmd-norm"] = 0.0
    flight["gear/gear-pos-norm"] = 0.0
    flight.run_ic()
    flight["propulsion/set-running"] = -1
    for found in flight.query_property_catalog("fcs/").split("\n"):
        found = found.split(" (")[0].strip()
        for start, value in {"fcs/mixture-cmd-norm": 0.87, "fcs/advance-cmd-norm": 1.0, "fcs/throttle-cmd-norm": 0.6}.items():
            if found.startswith(start):
                flight[found] = value
    try:
        flight.do_trim(0)
    except Exception:  # noqa: BLE001  JSBSim raises where it finds no trim; then the flight begins a little further from one.
        pass
    alpha, theta = flight["aero/alpha-deg"], flight["attitude/theta-deg"]
    out_of_trim = math.degrees(0.02)
    conditions.update({"alpha-deg": alpha + out_of_trim, "theta-deg": theta + out_of_trim})
    conditions.update({"beta-deg": out_of_trim, "phi-deg": math.degrees(0.1)})
    for key, value in conditions.items():
        flight[f"ic/{key}"] = value
    flight.run_ic()
    return flight


def samples(name, parts):
    """The angles at the samples, with so many times 120 steps a second."""
    flight = begun(name, parts)
    found = []
    for _ in range(round(DURATION_S / SAMPLE_S)):
        for _ in range(round(SAMPLE_S * RATE_HZ * parts)):
            flight.run()
        found.append([flight[angle] for angle in ANGLES])
    return found


def fastest(call, pieces=PIECES):
    """The processor time of one of PIECE_STEPS calls, s."""
    best = math.inf
    for _ in range(pieces):
        begin = time.process_time()
        for _ in range(PIECE_STEPS):
            call()
        best = min(best, (time.process_time() - begin) / PIECE_STEPS)
    return best


def measured(name):
    """The figures of JSBSim for one aircraft."""
    import jsbsim

    load_s = math.inf
    for _ in range(5):
        flight = jsbsim.FGFDMExec(None)
        flight.set_debug_level(0)
        begin = time.process_time()
        flight.load_model(name)
        load_s = min(load_s, time.process_time() - begin)
    coarse, fine = samples(name, 1), samples(name, FINE)
    error = max(abs(a - b) for one, two in zip(coarse, fine) for a, b in zip(one, two))
    # A new beginning for each piece, so that all are of the same 50 s of flight.
    step_s = math.inf
    for _ in range(PIECES):
        step_s = min(step_s, fastest(begun(name, 1).run, 1))
    flight = begun(name, 1)
    # A call that only gives a number.
    return {"load_s": load_s, "step_s": step_s, "loop_s": fastest(flight.get_sim_time), "error_rad": error}


def in_a_process(name):
    """Measures in a process of its own: JSBSim keeps what it read, prints, and may write files into the current folder."""
    with tempfile.TemporaryDirectory() as scratch:
        command = [sys.executable, os.path.abspath(__file__), "--one", name]
        done = subprocess.run(command, cwd=scratch, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=True, text=True)
    return json.loads(done.stdout.strip().rsplit("\n", 1)[-1])


def main():
    import jsbsim

    if sys.argv[1] == "--one":
        print("\n" + json.dumps(measured(sys.argv[2])))
        return
    program = sys.argv[1]
    names = sys.argv[2:] or list(CONDITIONS)
    unknown = [name for name in names if name not in CONDITIONS]
    if unknown:
        sys.exit(f"speed.py: no flight is given for {unknown[0]}; there are {', '.join(CONDITIONS)}")
    for name in names:
        theirs = [in_a_process(name)]
        folder = os.path.join(jsbsim.get_default_root_dir(), "aircraft", name)
        arguments = [program, folder, *(str(value) for value in CONDITIONS[name]), repr(theirs[0]["error_rad"])]
        ours = []
        for _ in range(2):
            lines = subprocess.run(arguments, stdout=subprocess.PIPE, check=True, text=True).stdout.splitlines()
            ours.append({key: float(value) for key, value in (line.split() for line in lines)})
            theirs.append(in_a_process(name))
        them = {key: min(one[key] for one in theirs) for key in theirs[0]}
        us = {key: min(one[key] for one in ours) for key in ours[0]}
        step_s = them["step_s"] - them["loop_s"]
        step_us = us["step_at_equal_error_s"]
        print(f"\n{name}, JSBSim {jsbsim.FGJSBBase().get_version()}")
        print(f"{'':42}{'here':>14}{'JSBSim':>14}{'ratio':>9}")
        for what, here, there in [
            ("evaluations per second", 1.0 / us["evaluation_s"], 1.0 / step_s),
            ("steps per second (Adams-Bashforth, both)", 1.0 / us["adams_bashforth_step_s"], 1.0 / step_s),
            ("steps per second (RK4; one evaluation)", 1.0 / us["rk4_step_s"], 1.0 / step_s),
            ("flight per second of processor, s", step_us / us["rk4_step_s"], 1.0 / RATE_HZ / step_s),
            ("loads per second", 1.0 / us["load_s"], 1.0 / them["load_s"]),
        ]:
            print(f"{what:42}{here:14,.0f}{there:14,.0f}{here / there:9.1f}")
        print(f"{'step, ms':42}{1000 * step_us:14.1f}{1000 / RATE_HZ:14.1f}")
        print(f"{'error of the step, rad':42}{us['error_rad']:14.1e}{them['error_rad']:14.1e}")
        print(f"time of a step of JSBSim {1e6 * step_s:.2f} us, besides {1e6 * them['loop_s']:.2f} us of the loop in Python")
        parts = [("evaluation", "evaluation_s"), ("coefficients", "aerodynamics_s"), ("propulsion", "propulsion_s")]
        print("time here, us: " + ", ".join(f"{what} {1e6 * us[key]:.2f}" for what, key in parts), flush=True)


if __name__ == "__main__":
    main()
