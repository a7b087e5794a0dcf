#!/bin/sh
# Checks what is off by default: the readers of Parquet, Arrow and MCAP with their tests, and all round trips. Built without
# optimisation, for their libraries take minutes to optimise.
set -eu
cd "$(dirname "$0")/.."

cargo test --quiet --locked --profile quick -p phugoid-flight-data --features excel,gzip,matlab,mcap,parquet
scripts/round-trips.sh
