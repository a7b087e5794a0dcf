#!/bin/sh
# Checks what is off by default, and what .ci/run has no time for (it takes a quarter of an hour on two cores): the readers of
# Parquet, Arrow and MCAP, the terminal view, and their round trips. To be run where one of them changes, and before a release.
set -eu
cd "$(dirname "$0")/.."

cargo clippy -p phugoid --all-features --locked -- -D warnings
cargo test -p phugoid-flight-data --features matlab,mcap,parquet --locked
cargo test -p phugoid --features parquet --locked --test inspect
scripts/round-trips.sh all
