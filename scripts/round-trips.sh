#!/bin/sh
# Round trips against the formats' own tools: what they write or read has to give the same numbers here.
#   scripts/round-trips.sh default    the formats of the default build, but for tables: ULog, DataFlash, MAVLink, and the export to JSBSim
#   scripts/round-trips.sh [all]      Parquet, Arrow, MATLAB and MCAP too, whose libraries take minutes to build
# Every script tests/python/round_trip_*.py is run with the environment of scripts/python-tools.sh; it finds the binaries that
# it needs in the folder of $PHUGOID_EXAMPLES and the shared data, if there are any, in $PHUGOID_SHARED_DATA.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh

target=${CARGO_TARGET_DIR:-target}
case ${1:-all} in
    default)
        # With the features of the tests, so that nothing is built twice.
        cargo build --quiet --locked --workspace --examples
        formats="ulog dataflash mavlink jsbsim"
        ;;
    all)
        cargo build --quiet --locked -p phugoid-flight-data --features matlab,mcap,parquet --example dump_log --example read_table
        cargo build --quiet --locked -p phugoid-identification --features parquet --example export_model --example export_estimates
        cargo build --quiet --locked -p phugoid-live --example dump_mavlink
        formats="ulog dataflash mavlink jsbsim tables mcap"
        ;;
    *)
        echo "round trips: default or all, not $1" >&2
        exit 2
        ;;
esac

PHUGOID_EXAMPLES=$(cd "$target/debug/examples" && pwd)
PHUGOID_SHARED_DATA=${PHUGOID_SHARED_DATA:-$(pwd)/../shared/data}
export PHUGOID_EXAMPLES PHUGOID_SHARED_DATA

for format in $formats; do
    echo "round trip: $format"
    target/python/bin/python "tests/python/round_trip_$format.py"
done
echo "round trips: all the same"
