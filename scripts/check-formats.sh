#!/bin/sh
# Checks what is off by default: the readers of Parquet, Arrow and MCAP with their tests, and all round trips. Built without
# optimisation, for their libraries take minutes to optimise.
#
#     scripts/check-formats.sh [compile]     only compiles
set -eu
cd "$(dirname "$0")/.."

# `--no-run` where it is only to be compiled.
no_run=
[ "${1:-}" != compile ] || no_run=--no-run
cargo test --quiet --locked --profile quick -p phugoid-flight-data --features excel,gzip,matlab,mcap,parquet $no_run
[ -z "$no_run" ] || exit 0
scripts/round-trips.sh
