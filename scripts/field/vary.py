#!/usr/bin/env python3
"""Records the sound flights of a field again with other instruments: more noise, noise that lasts, coarse steps, half the rate, uneven times.

    scripts/field/vary.py FIELD FOLDER [--only noisier lasting coarse half uneven] [--split develop|look-once]

FIELD is a folder of `make.py`. FOLDER/KIND has the same flights with the same truths, without damages and trim shifts, and is run by
`phugoid field FOLDER/KIND`. The same numbers come out every time. docs/field.md says what was found with them.
"""

import argparse
import json
import math
import pathlib
import shutil
import zlib

import numpy as np

from instruments import CLASS, COLUMNS

# Steps of the instruments in the kind `coarse`, SI.
STEP = {"tas": 0.5, "altitude": 1.0, "angle": math.radians(0.1), "rate": math.radians(0.2), "acceleration": 0.05}
# Standard deviation of the lasting noise over that of the record, and how long it lasts, s.
LASTING = 1.0, 0.3
# Standard deviation of the kind `noisier` over that of the record.
NOISIER = 3.0
# Largest error of a time in the kind `uneven`, in sample times.
UNEVEN = 0.1


def noisier(values, noise, quantity, step, rng):
    return values + math.sqrt(NOISIER**2 - 1) * noise * rng.standard_normal(len(values))


def lasting(values, noise, quantity, step, rng):
    share, lasts = LASTING
    keep = math.exp(-step / lasts)
    drawn = rng.standard_normal(len(values))
    course = np.empty(len(values))
    course[0] = drawn[0]
    for k in range(1, len(values)):
        course[k] = keep * course[k - 1] + math.sqrt(1 - keep**2) * drawn[k]
    return values + share * noise * course


def coarse(values, noise, quantity, step, rng):
    return np.round(values / STEP[quantity]) * STEP[quantity]


CHANNELS = {"noisier": noisier, "lasting": lasting, "coarse": coarse}
KINDS = (*CHANNELS, "half", "uneven")


def known_columns() -> dict:
    """By header, the channel, its quantity and SI per unit."""
    known = {}
    for table in COLUMNS.values():
        for channel, quantity in CLASS.items():
            suffix, unit, _ = table[quantity]
            known[suffix if quantity in ("tas", "altitude") else f"{channel}_{suffix}"] = channel, quantity, unit
    return known


def vary(record: pathlib.Path, truth: dict, kind: str, known: dict) -> tuple[list, np.ndarray]:
    """Header and samples of the record with the other instruments; missing values stay missing."""
    header, *lines = record.read_text().splitlines()
    header = header.split(",")
    table = np.array([[float(x) if x else math.nan for x in line.split(",")] for line in lines])
    rng = np.random.default_rng(zlib.crc32(f"{kind} {truth['aircraft']} {truth['flight']}".encode()))
    step = float(np.median(np.diff(table[:, 0])))
    if kind == "half":
        return header, table[::2]
    if kind == "uneven":
        table[1:, 0] += UNEVEN * step * rng.uniform(-1, 1, len(table) - 1)
        return header, table
    for j, name in enumerate(header):
        if name in known:
            channel, quantity, unit = known[name]
            table[:, j] = CHANNELS[kind](table[:, j] * unit, truth["noise"][channel], quantity, step, rng) / unit
    return header, table


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("field", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--only", nargs="+", choices=KINDS, default=KINDS)
    parser.add_argument("--split", choices=("develop", "look-once"), default="look-once")
    arguments = parser.parse_args()
    source = arguments.field / arguments.split
    if not any(source.glob("*/*.truth.json")):
        parser.error(f"{source} has no flights with their truth: make them with scripts/field/make.py, or name the other part with --split")
    known = known_columns()
    count = 0
    for aircraft in sorted(p for p in source.iterdir() if p.is_dir()):
        for kind in arguments.only:
            (arguments.folder / kind / arguments.split / aircraft.name).mkdir(parents=True, exist_ok=True)
            for model in aircraft.glob("*.toml"):
                shutil.copy(model, arguments.folder / kind / arguments.split / aircraft.name)
        for path in sorted(aircraft.glob("*.truth.json")):
            truth = json.loads(path.read_text())
            if truth["group"] in ("damage", "trim shift") or truth["kind"] != "sound":
                continue
            count += 1
            for kind in arguments.only:
                place = arguments.folder / kind / arguments.split / aircraft.name
                header, table = vary(aircraft / truth["record"], truth, kind, known)
                rows = (",".join("" if math.isnan(x) else f"{x:.8g}" for x in row) for row in table)
                (place / truth["record"]).write_text("\n".join([",".join(header), *rows]) + "\n")
                changed = truth | {"rate_hz": truth["rate_hz"] / 2} if kind == "half" else truth
                (place / path.name).write_text(json.dumps(changed, indent=1) + "\n")
    print(f"{count} flights, recorded in {len(arguments.only)} other ways")


if __name__ == "__main__":
    main()
