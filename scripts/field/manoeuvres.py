#!/usr/bin/env python3
"""Compares the manoeuvres that `phugoid inspect` finds with those that the field flew:

    scripts/field/manoeuvres.py target/release/phugoid target/field develop

A manoeuvre counts as found if an input of its surface begins within 0.8 s of its planned start (0.3 s of it are drawn). Its kind counts as right if it is the one
that was flown: a 2-3-1-1 is a multi-step, and a random stick is an `other` input. Where several random sticks are
flown at once, one surface is enough. The flights with a random stick and a re-trim are in the table of all groups.
"""

import collections
import json
import pathlib
import subprocess
import sys

from aircraft import FLEET
from catalogue import flights

KINDS = {"3211": "3-2-1-1", "doublet": "doublet", "pulse": "pulse", "2311": "multi-step", "stick": "other"}


def main() -> None:
    program, field, split = sys.argv[1:4]
    words = sys.argv[4:]
    table = collections.defaultdict(lambda: [0, 0, 0, 0])
    for spec in FLEET:
        for plan in flights(spec, split):
            path = pathlib.Path(field, split, spec.name, f"{plan.name}.csv")
            if not path.exists() or (words and not any(w in plan.name for w in words)):
                continue
            found = json.loads(subprocess.run([program, "inspect", str(path), "--json"], capture_output=True, check=True).stdout)
            inputs = [i for m in found["found"]["manoeuvres"] for i in m["inputs"]]
            row = table[f"{plan.axes} {plan.group}"]
            taken = []
            for manoeuvre in plan.manoeuvres:
                kind, surface, start = manoeuvre[:3]
                row[0] += 1
                near = [i for i in inputs if i["surface"] == surface and abs(i["onset_s"] - start) <= 0.8]
                taken += near
                row[1] += bool(near)
                right = any(i["kind"] == KINDS[kind] for i in near)
                row[2] += right
                if not right:
                    around = [(i["kind"], round(i["onset_s"], 2), round(i["end_s"], 2)) for i in inputs if i["surface"] == surface]
                    print(spec.name, plan.name, plan.rate_hz, kind, surface, start, "found:", around)
            row[3] += len([i for i in inputs if i not in taken])
    print(f"{'group':40} flown found kind more")
    for name, row in sorted(table.items()):
        print(f"{name:40} {row[0]:5} {100 * row[1] / row[0]:4.0f}% {100 * row[2] / row[0]:3.0f}% {row[3]:4}")
    all_ = [sum(row[k] for row in table.values()) for k in range(4)]
    print(f"{'all':40} {all_[0]:5} {100 * all_[1] / all_[0]:4.1f}% {100 * all_[2] / all_[0]:4.1f}% {all_[3]:4}")


main()
