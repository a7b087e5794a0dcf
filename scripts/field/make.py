#!/usr/bin/env python3
"""Flies the field: foreign aircraft of JSBSim, recorded as a stranger would, with the truth beside each record.

    scripts/field/make.py [FOLDER] [--aircraft NAME ...] [--only TEXT ...] [--split develop|look-once]
                          [--repetition N] [--jobs N] [--exact]
    scripts/field/make.py FOLDER --feedback [...]
    scripts/field/make.py FOLDER --structure [...]
    scripts/field/make.py FOLDER --gliding [...]
    scripts/field/make.py FOLDER --large [...]
    scripts/field/make.py FOLDER --propeller [...]
    scripts/field/make.py FOLDER --quiet [...]
    scripts/field/make.py FOLDER --whole [...]
    scripts/field/make.py FOLDER --other [...]
    scripts/field/make.py crates/phugoid-evaluation/tests/field --sample
    scripts/field/make.py crates/phugoid-evaluation/tests/field-whole --whole --sample

Needs `jsbsim` and `numpy` as pinned in tests/python/requirements.txt. The same numbers come out every time.
docs/field.md says what the flights are.
"""

import argparse
import json
import multiprocessing
import os
import pathlib
import sys
import tempfile
import time

import numpy as np

import instruments
import model_file
import truth
from aircraft import FLEET, NEWCOMERS, STRANGERS
from catalogue import FEEDBACK_REPETITIONS, REPETITIONS, SAMPLE, WHOLE_SAMPLE, feedback_flights, flights, gliding_flights, large_flights, other_flights, propeller_flights, quiet_flights, structure_flights, turning_flights, whole_flights
from fly import Plan, fly
from simulator import Simulator
from whole import Whole


def write_exact(path: pathlib.Path, at: np.ndarray, rows: np.ndarray, flown) -> None:
    """What happened at the times of the record, without instruments: coefficients and what terms are made of."""
    names = ("true_airspeed_m_s", "alpha_rad", "beta_rad", "p_rad_s", "q_rad_s", "r_rad_s", "elevator_rad", "aileron_rad", "rudder_rad")
    channels = ("tas", "alpha", "beta", "p", "q", "r", "elevator", "aileron", "rudder")
    columns = [at, *(flown.channels[c][rows] for c in channels), *(flown.coefficients[c][rows] for c in flown.coefficients)]
    # Readers do not tell CL from Cl.
    called = {"CL": "c_lift", "CD": "c_drag", "CY": "c_side", "Cl": "c_roll", "Cm": "c_pitch", "Cn": "c_yaw"}
    header = ",".join(("time_s", *names, *(called[c] for c in flown.coefficients)))
    np.savetxt(path, np.column_stack(columns), fmt="%.9g", delimiter=",", header=header, comments="")


def model_name(plan: Plan) -> str:
    """Which model file belongs to a flight; an aircraft that glides has no thrust to record, and that of a propeller nobody records."""
    kind = "glide-" if plan.gliding else "propeller-" if plan.propeller else "whole-" if plan.whole else ""
    return f"{kind}{plan.axes}.toml"


def thrust_of(plan: Plan, trim: dict) -> str:
    """What the model file says of the thrust. Of a propeller the engineer knows what level flight at the usual speed takes."""
    if plan.gliding:
        return '"0 N"'
    return f'"{trim["thrust"]:.4g} N"' if plan.propeller or plan.whole else '{ channel = "thrust" }'


def one_flight(sim: Simulator, plan: Plan, split: str, folder: pathlib.Path, exact: bool = False) -> dict:
    """Flies, records and writes one flight; returns its truth."""
    spec = sim.spec
    rng = np.random.default_rng(plan.seed)
    flown = fly(sim, plan, rng)
    at, columns, noise = instruments.record(flown, plan, spec, np.random.default_rng([plan.seed, 1]))
    instruments.write_csv(folder / f"{plan.name}.csv", at, columns, spec)
    x = truth.regressors(flown.channels, sim.chord, sim.span, flown.trim["speed"])
    rows = np.searchsorted(flown.time, at - 1e-9)
    if exact:
        write_exact(folder / f"{plan.name}.exact.csv", at, rows, flown)
    out = {
        "flight": plan.name,
        "aircraft": spec.name,
        "stands_for": spec.stands_for,
        "split": split,
        "kind": plan.kind,
        "group": plan.group,
        "axes": plan.axes,
        "loop": plan.loop,
        "gust_m_s": plan.gust,
        "turning": plan.turning,
        "rate_hz": plan.rate_hz,
        "duration_s": plan.duration,
        "seed": plan.seed,
        "model": model_name(plan),
        "record": f"{plan.name}.csv",
        "trim": {k: v for k, v in flown.trim.items() if k != "response"},
        "noise": noise,
        "instruments": plan.instruments,
    }
    damage_at = plan.damage[0] if plan.damage else None
    # The sample at the time of the damage was taken before it: what is seen of it begins with the next.
    is_after = np.zeros(len(rows), dtype=bool) if damage_at is None else flown.time[rows] > damage_at + 1e-9
    before = rows[~is_after]
    missing = {name: value for name, value in flown.added.items() if name in plan.added}
    parameters, explained = truth.fit(flown.coefficients, x, plan.axes, before, plan.rate_hz, missing)
    out["truth"] = {"parameters": parameters, "explained": explained, "until_s": damage_at}
    if missing:
        # By coefficient and term, as a model file writes it.
        words = {"V": "v_hat", "alpha2": "alpha^2", "beta2": "beta^2", "abs_elevator": "|elevator|", "q": "q_hat"}
        split_names = (name.split("_", 1) for name in missing)
        out["missing"] = [[coefficient, words.get(variable, variable)] for coefficient, variable in split_names]
    if damage_at is not None:
        after, explained = truth.fit(flown.coefficients, x, plan.axes, rows[is_after], plan.rate_hz)
        out["change"] = {"time_s": damage_at, "changes": flown.changes, "after": after, "explained": explained}
    (folder / f"{plan.name}.truth.json").write_text(json.dumps(out, indent=1) + "\n")
    return out


def one_aircraft(job) -> list[str]:
    """All flights of one aircraft in one part; returns a line per flight."""
    spec, split, repetition, folder, step, wanted, exact, catalogue = job
    place = folder / split / spec.name
    place.mkdir(parents=True, exist_ok=True)
    lines = []
    with tempfile.TemporaryDirectory() as scratch:
        plans = [
            plan
            for plan in catalogue(spec, split, repetition)
            # Also behind the word of a catalogue: `large-lat-calm`.
            if wanted(spec, plan) and not any(f"-{begin}" in f"-{plan.name}" for begin in spec.left_out)
        ]
        if not plans:
            return []

        def simulator():
            bare = Simulator(spec, pathlib.Path(scratch), step)
            return Whole(bare) if plans[0].whole else bare

        sim = simulator()
        usual = sim.trim(spec.speed, spec.altitude)
        for plan in {model_name(plan): plan for plan in plans}.values():
            model_file.write(place / model_name(plan), sim, spec, plan.axes, thrust_of(plan, usual))
        for plan in plans:
            try:
                # Another one for each flight, so that nothing of the last one is left in it.
                made = one_flight(simulator(), plan, split, place, exact)
                explained = " ".join(f"{k} {v:.3f}" for k, v in made["truth"]["explained"].items())
                lines.append(f"{split:9} {spec.name:10} {plan.name:22} {plan.group:18} R2 of the terms: {explained}")
            except RuntimeError as error:
                lines.append(f"{split:9} {spec.name:10} {plan.name:22} LEFT OUT: {error}")
    return lines


class Wanted:
    """Which flights are asked for; a class, so that it can be sent to another process."""

    def __init__(self, only: list[str], sample: dict | None):
        self.only, self.sample = only, sample

    def __call__(self, spec, plan: Plan) -> bool:
        if self.sample:
            return plan.name in self.sample[spec.name]
        return not self.only or any(text in plan.name for text in self.only)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", default="target/field", type=pathlib.Path)
    parser.add_argument("--only", nargs="+", default=[], help="flights whose name contains one of these")
    parser.add_argument("--aircraft", nargs="+", default=[], help="these aircraft only")
    parser.add_argument("--strangers", action="store_true", help="the aircraft that came later, which are in neither part")
    parser.add_argument("--newcomers", action="store_true", help="aircraft of other kinds that came after those, in neither part either")
    parser.add_argument("--split", choices=("develop", "look-once"), help="this part only")
    parser.add_argument(
        "--repetition",
        type=int,
        help="another repetition of these flights, with conditions, times, sizes, gusts and noise that nobody has seen",
    )
    parser.add_argument("--sample", action="store_true", help="the few flights that are kept in the project")
    others = parser.add_mutually_exclusive_group()
    others.add_argument("--feedback", action="store_true", help="stabilised aircraft in place of the field: flights with a flight control system")
    others.add_argument("--gliding", action="store_true", help="flights without thrust, in place of the field")
    others.add_argument("--large", action="store_true", help="flights without damage and with inputs two and a half times as large, in place of the field")
    others.add_argument("--propeller", action="store_true", help="flights whose thrust falls with the airspeed and is not recorded, in place of the field")
    others.add_argument("--quiet", action="store_true", help="flights without any manoeuvre, in place of the field")
    others.add_argument("--other", action="store_true", help="flights with sweeps, multisines and other inputs that the field has not, in its place")
    others.add_argument("--whole", action="store_true", help="flights of aircraft with their own engines and controls, in place of the field")
    others.add_argument("--turning", action="store_true", help="flights in JSBSim's own turbulence, which turns the air as well, in place of the field")
    others.add_argument("--structure", action="store_true", help="flights of aircraft with a term that no model file has, in place of the field")
    parser.add_argument("--exact", action="store_true", help="beside each record what happened without instruments, as NAME.exact.csv")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--step", type=float, default=1 / 600, help="step of the simulation, s")
    arguments = parser.parse_args()
    if arguments.repetition is not None:
        if arguments.split is None:
            parser.error("--repetition needs --split: both parts would have the same flights")
        taken = FEEDBACK_REPETITIONS if arguments.feedback else REPETITIONS
        if arguments.repetition in sum(taken.values(), ()):
            parser.error(f"--repetition {arguments.repetition} is one of those of the field itself")
    began = time.time()
    splits = ("develop",) if arguments.sample else (arguments.split,) if arguments.split else ("develop", "look-once")
    sample = (WHOLE_SAMPLE if arguments.whole else SAMPLE) if arguments.sample else None
    aircraft = list(sample) if sample else arguments.aircraft
    everyone = FLEET + STRANGERS + NEWCOMERS
    if unknown := set(aircraft) - {spec.name for spec in everyone}:
        parser.error(f"no such aircraft: {', '.join(sorted(unknown))}; there are {', '.join(spec.name for spec in everyone)}")
    wanted = Wanted(arguments.only, sample)
    kinds = {"feedback": feedback_flights, "structure": structure_flights, "gliding": gliding_flights, "large": large_flights, "propeller": propeller_flights, "quiet": quiet_flights, "other": other_flights, "whole": whole_flights, "turning": turning_flights}
    catalogue = next((made for kind, made in kinds.items() if getattr(arguments, kind)), flights)
    jobs = [
        (spec, split, arguments.repetition, arguments.folder, arguments.step, wanted, arguments.exact, catalogue)
        for split in splits
        for spec in everyone
        if (spec.name in aircraft if aircraft else spec in (NEWCOMERS if arguments.newcomers else STRANGERS if arguments.strangers else FLEET)) and not (split == "develop" and spec.look_once_only)
    ]
    made = left_out = 0
    # A process of its own for each aircraft: JSBSim ends the process where a description is wrong.
    with multiprocessing.Pool(arguments.jobs, maxtasksperchild=1) as pool:
        for lines in pool.imap(one_aircraft, jobs):
            for line in lines:
                made += 1
                left_out += "LEFT OUT" in line
                print(line, flush=True)
    if made == 0:
        # Not every aircraft is in every catalogue: some cannot fly with their own engines, some have no flight control system here.
        sys.exit(f"no flight was made: this kind of flights has none of {', '.join(aircraft) or 'these aircraft'} with these names in {', '.join(splits)}")
    print(f"{time.time() - began:.0f} s, {left_out} flights left out", file=sys.stderr)


if __name__ == "__main__":
    main()
