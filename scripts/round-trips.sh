#!/bin/sh
# Round trips against the formats' own tools: what they write or read has to give the same numbers here. Every script
# tests/python/round_trip_*.py is run with the environment of scripts/python-tools.sh; it finds the binaries that it needs
# in the folder of $PHUGOID_EXAMPLES and the shared data, if there are any, in $PHUGOID_SHARED_DATA.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh

target=${CARGO_TARGET_DIR:-target}
cargo build --quiet --locked -p phugoid-flight-data --features matlab,mcap,parquet --example dump_log --example read_table
cargo build --quiet --locked -p phugoid-identification --example export_model

PHUGOID_EXAMPLES=$(cd "$target/debug/examples" && pwd)
PHUGOID_SHARED_DATA=${PHUGOID_SHARED_DATA:-$(pwd)/../shared/data}
export PHUGOID_EXAMPLES PHUGOID_SHARED_DATA

for script in tests/python/round_trip_*.py; do
    echo "round trip: $script"
    target/python/bin/python "$script"
done
echo "round trips: all the same"
