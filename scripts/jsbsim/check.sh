#!/bin/sh
# Compares the reader of JSBSim's aircraft with JSBSim itself: brings its Python package (scripts/python-tools.sh), lets it fly
# aircraft once, and fails if forces, masses, thrust or flight control come out otherwise.
#
#   scripts/jsbsim/check.sh                 every aircraft of the package but those set aside: minutes of recording
#   scripts/jsbsim/check.sh c182 parts      these alone
set -eu
cd "$(dirname "$0")/../.."

scripts/python-tools.sh
python=$(pwd)/target/python/bin/python
recorded=$(pwd)/target/jsbsim
[ $# -eq 0 ] || recorded=$recorded-$(echo "$*" | tr ' ' '-')

[ -n "$(ls "$recorded" 2>/dev/null)" ] || "$python" scripts/jsbsim/record.py "$recorded" "$@"
# Said by name, so that the tests fail where they would otherwise be skipped.
PHUGOID_JSBSIM=$("$python" -c 'import jsbsim, os; print(os.path.dirname(jsbsim.__file__))') \
PHUGOID_JSBSIM_RECORDED=$recorded \
    cargo test --workspace --release --locked --test integration -- jsbsim
