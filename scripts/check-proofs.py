#!/usr/bin/env python3
"""Proves, for all inputs of a stated domain, what the parts with the index arithmetic of the estimators do: as machine code for a
Cortex-M, compiled from the library's own sources as for a flight.

crates/phugoid-estimators/proofs has the entry points; scripts/proofs executes them with symbols in place of numbers, on every
path, and compares the results with the textbook's formulas as terms, or asks z3. Each claim is then tried on sources with a
mistake in one line, where it must not hold: a check that could not fail would be at fault itself.

Needs pyvex and z3-solver from PyPI: scripts/python-tools.sh target/proofs/python scripts/proofs/requirements.txt installs them.
Usage: target/proofs/python/bin/python scripts/check-proofs.py [CLAIM ...]
"""

import multiprocessing
import os
import pathlib
import shutil
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
ESTIMATORS = ROOT / "crates" / "phugoid-estimators"
TARGET = "thumbv7em-none-eabihf"
sys.path.insert(0, str(ROOT / "scripts" / "proofs"))

try:
    from claims import CLAIMS
    from machine import Image, Undecided, Violation
except ModuleNotFoundError as missing:
    print(f"check-proofs: nothing is proved, because {missing.name} is not installed (see the head of this script)")
    sys.exit(1)


def built(proofs, target):
    """The image of the entry points."""
    environment = dict(os.environ, CARGO_TARGET_DIR=str(target), CARGO_INCREMENTAL="0")
    for overriding in ("RUSTFLAGS", "CARGO_ENCODED_RUSTFLAGS", "CARGO_BUILD_TARGET"):
        environment.pop(overriding, None)
    command = ["cargo", "build", "--quiet", "--locked", "--release", "--target", TARGET]
    subprocess.run(command, cwd=proofs, env=environment, check=True)
    return Image(target / TARGET / "release" / "phugoid-proofs")


def with_mistake(folder, file, right, wrong):
    """The crate of the entry points beside sources of which one line is another."""
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("src", "proofs"):
        shutil.copytree(ESTIMATORS / part, folder / part)
    path = folder / "src" / file
    text = path.read_text()
    if text.count(right) != 1:
        raise RuntimeError(f"the line for the mistake is not once in {file}: {right}")
    path.write_text(text.replace(right, wrong))
    return folder / "proofs"


def tried(name):
    """Proves a claim, then tries it where it must not hold. Gives what there is to say, and whether all is well."""
    claim, text, mistake = CLAIMS[name]
    work = folder()
    start = time.monotonic()
    try:
        claim(Image(work / "build" / TARGET / "release" / "phugoid-proofs"))
    except (Violation, Undecided, NotImplementedError) as why:
        return f"{name}: NOT PROVED: {text}\n    {why}", False
    told = f"{name}: proved in {time.monotonic() - start:.1f} s: {text}"
    wrong = built(with_mistake(work / name, *mistake), work / name / "target")
    try:
        claim(wrong)
    except Violation as why:
        return f"{told}\n    with `{mistake[2].strip()}` in {mistake[0]}: {str(why)[:160]}", True
    return f"{told}\n    THE MISTAKE `{mistake[2].strip()}` IS NOT FOUND: this claim proves nothing", False


def folder():
    return pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "proofs"


def main():
    wanted = sys.argv[1:] or list(CLAIMS)
    if unknown := [name for name in wanted if name not in CLAIMS]:
        sys.exit(f"check-proofs: there is no claim {', '.join(unknown)}; there are {', '.join(CLAIMS)}")
    begun = time.monotonic()
    built(ESTIMATORS / "proofs", folder() / "build")
    failed = 0
    with multiprocessing.Pool(os.cpu_count()) as pool:
        # From the last one on: these take longest.
        for text, well in pool.imap(tried, sorted(wanted, key=list(CLAIMS).index, reverse=True), chunksize=1):
            print(text, flush=True)
            failed += not well
    if failed:
        sys.exit(f"check-proofs: {failed} of {len(wanted)} claims failed")
    print(f"check-proofs: {len(wanted)} claims proved, each with a mistake that is found, in {time.monotonic() - begun:.0f} s")


if __name__ == "__main__":
    main()
