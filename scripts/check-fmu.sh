#!/bin/sh
# Exports aircraft as FMUs and simulates them with FMPy: its validation, both interfaces against `phugoid simulate`, and what is
# wrong on purpose. Built without optimisation, as all that is run once or twice.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh target/fmu/python scripts/fmu/requirements.txt
cargo build --quiet --locked --profile quick -p phugoid-cli -p phugoid-fmi --features phugoid-cli/fmu
target/fmu/python/bin/python scripts/fmu/check.py "${CARGO_TARGET_DIR:-target}/quick" target/fmu/files
