#!/usr/bin/env bash
# Interprets tests of the no_std estimators with Miri, which sees what an ordinary run does not: arithmetic of pointers
# and slices that leaves its object, values that are none of their type, uninitialised memory. The crate itself forbids
# unsafe code, so that this checks what it rests on: slices in chunks, arrays filled place by place, libm.
#
# A chosen set, because Miri takes some hundred times as long: small tests of every module that computes indices. Tests
# that try all short sequences of something try shorter ones here (`cfg!(miri)`), random ones few cases. Needs a nightly
# toolchain with Miri, which nothing else needs; where there is none it says so and ends with 0.
#
#   scripts/miri.sh            the set
#   scripts/miri.sh NAME ...   these tests of the library instead
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if ! cargo +nightly miri setup > /dev/null 2>&1; then
    echo "miri: not checked, because there is no nightly toolchain with Miri" \
        "(rustup component add miri rust-src --toolchain nightly)"
    exit 0
fi

# The tests of files read the clock and the environment.
export MIRIFLAGS="-Zmiri-disable-isolation"
export PROPTEST_CASES=2
# libm has routines in assembly, which cannot be interpreted; the others give the same numbers.
options=(-p phugoid-estimators --features libm/force-soft-floats)

library=(
    kernels:: bounded:: dense:: statistics::            # blocks of four and their rests, places in lists, triangles
    columns::                                           # parameters and biases in one room
    supervisor::history:: supervisor::probation::       # the ring of frames and its snapshots
    supervisor::colour:: supervisor::faults:: supervisor::trial::
    regression::rows:: regression::pole:: regression::gate::
    levels::bank::                                      # shadows, outputs that are missing
    health::starts:: health::assumptions:: health::evidence::tests::numbers_that_are_none
    smpe::reopen:: change_detection::challenge:: verdict::collinearity::
)
[ $# -eq 0 ] || library=("$@")
cargo +nightly miri test "${options[@]}" --lib -- "${library[@]}"
# The factored covariance: updates, time updates and solutions of random sizes in a room of seven.
[ $# -ne 0 ] || cargo +nightly miri test "${options[@]}" --test integration -- ud:: --skip stays_positive
