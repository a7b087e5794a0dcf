#!/bin/sh
# Exports aircraft as FMUs and simulates them with FMPy: its validation, both interfaces against `phugoid simulate`, and what is
# wrong on purpose.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh target/fmu/python scripts/fmu/requirements.txt
# Of the whole workspace with its examples, as the tests have built it: of two crates alone, or without examples, the libraries have
# other features, and all would be built once more.
cargo build --quiet --locked --release --workspace --bins --lib --examples
target/fmu/python/bin/python scripts/fmu/check.py "${CARGO_TARGET_DIR:-target}/release" target/fmu/files
