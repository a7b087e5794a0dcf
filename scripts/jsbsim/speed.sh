#!/bin/sh
# Compares the speed of aircraft of JSBSim, as read and flown here, with that of JSBSim itself, in one run on one machine:
# evaluations and steps per second, flight per second of processor time at equal error of the step, time to load.
#
#   scripts/jsbsim/speed.sh               c182 and f15 (the fokker100 asks JSBSim for properties that only FlightGear has)
#   scripts/jsbsim/speed.sh c182          one of them
set -eu
cd "$(dirname "$0")/../.."

scripts/python-tools.sh
cargo build --release --locked -p phugoid-aircraft --example flown_speed
target/python/bin/python scripts/jsbsim/speed.py "${CARGO_TARGET_DIR:-target}/release/examples/flown_speed" "$@"
