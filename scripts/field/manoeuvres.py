#!/usr/bin/env python3
"""Compares the manoeuvres that `phugoid inspect` finds with those that the field flew:

    scripts/field/manoeuvres.py target/release/phugoid target/field develop
    scripts/field/manoeuvres.py target/release/phugoid target/strangers look-once --strangers --repetition 303
    scripts/field/manoeuvres.py target/release/phugoid target/quiet develop --quiet

A manoeuvre counts as found if an input of its surface begins within 0.8 s of its planned start (0.3 s of it are drawn). Its
kind counts as right if it is the one that was flown: a 2-3-1-1 is a multi-step, and a random stick is an `other` input. The
last column counts inputs where none was flown; some of them are motions that the surface made: a re-trim, what a control loop
does after a damage, a rudder that is coupled to the ailerons. In flights without manoeuvres (`--quiet`) every input is false.
"""

import argparse
import collections
import json
import pathlib
import subprocess

from aircraft import FLEET, NEWCOMERS, STRANGERS
from catalogue import feedback_flights, flights, quiet_flights

KINDS = {"3211": "3-2-1-1", "doublet": "doublet", "pulse": "pulse", "2311": "multi-step", "stick": "other"}


def part(count: int, of: int) -> str:
    return f"{100 * count / of:5.1f}%" if of else "     -"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("field", type=pathlib.Path)
    parser.add_argument("split", choices=("develop", "look-once"))
    parser.add_argument("words", nargs="*", help="flights whose name contains one of these")
    parser.add_argument("--repetition", type=int)
    fleets = parser.add_mutually_exclusive_group()
    fleets.add_argument("--strangers", action="store_true")
    fleets.add_argument("--newcomers", action="store_true")
    catalogues = parser.add_mutually_exclusive_group()
    catalogues.add_argument("--feedback", action="store_true")
    catalogues.add_argument("--quiet", action="store_true")
    arguments = parser.parse_args()
    fleet = STRANGERS if arguments.strangers else NEWCOMERS if arguments.newcomers else FLEET
    catalogue = feedback_flights if arguments.feedback else quiet_flights if arguments.quiet else flights
    table = collections.defaultdict(lambda: [0] * 5)
    for spec in fleet:
        for plan in catalogue(spec, arguments.split, arguments.repetition):
            path = arguments.field / arguments.split / spec.name / f"{plan.name}.csv"
            if not path.exists() or (arguments.words and not any(w in plan.name for w in arguments.words)):
                continue
            answer = subprocess.run([arguments.program, "inspect", str(path), "--json"], capture_output=True, check=True).stdout
            inputs = [i for m in json.loads(answer)["found"]["manoeuvres"] for i in m["inputs"]]
            row = table[f"{plan.axes} {plan.group}"]
            row[0] += 1
            taken = []
            for manoeuvre in plan.manoeuvres:
                kind, surface, start = manoeuvre[:3]
                row[1] += 1
                near = [i for i in inputs if i["surface"] == surface and abs(i["onset_s"] - start) <= 0.8]
                taken += near
                row[2] += bool(near)
                right = any(i["kind"] == KINDS[kind] for i in near)
                row[3] += right
                if not right:
                    around = [(i["kind"], round(i["onset_s"], 2), round(i["end_s"], 2)) for i in inputs if i["surface"] == surface]
                    print(spec.name, plan.name, plan.rate_hz, kind, surface, start, "found:", around)
            more = [i for i in inputs if i not in taken]
            row[4] += len(more)
            for i in more:
                print(spec.name, plan.name, plan.rate_hz, "more:", i["surface"], i["kind"], round(i["onset_s"], 2), round(i["end_s"], 2))
    table["all"] = [sum(row[k] for row in table.values()) for k in range(5)]
    print(f"{'group':40} flights flown  found   kind more")
    for name, (of, flown, found, right, more) in sorted(table.items(), key=lambda row: (row[0] == "all", row[0])):
        print(f"{name:40} {of:7} {flown:5} {part(found, flown)} {part(right, flown)} {more:4}")


main()
