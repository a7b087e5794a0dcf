#!/bin/sh
# Round trips against the formats' own tools: what they write or read has to give the same numbers here.
# ULog, DataFlash, MAVLink, telemetry logs, the export to JSBSim; Parquet, Arrow, MATLAB, MCAP and workbooks of Excel, whose libraries
# are off by default.
# Every script tests/python/round_trip_*.py is run with the environment of scripts/python-tools.sh; it finds the binaries that
# it needs in the folder of $PHUGOID_EXAMPLES and the shared data, if there are any, in $PHUGOID_SHARED_DATA.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh
PHUGOID_SHARED_DATA=${PHUGOID_SHARED_DATA:-$(pwd)/../shared/data}
export PHUGOID_SHARED_DATA

# round_trip FOLDER_OF_THE_PROFILE FORMAT...
round_trip() {
    PHUGOID_EXAMPLES=$(cd "${CARGO_TARGET_DIR:-target}/$1/examples" && pwd)
    export PHUGOID_EXAMPLES
    shift
    for format in "$@"; do
        echo "round trip: $format"
        target/python/bin/python "tests/python/round_trip_$format.py"
    done
}

# With the features of the tests, so that nothing is built twice.
cargo build --quiet --locked --release --workspace --examples
round_trip release ulog dataflash mavlink tlog jsbsim

scripts/optional.py examples dump_log read_table export_estimates export_workbook
round_trip quick tables mcap
echo "round trips: all the same"
