#!/bin/sh
# Compares the reader of JSBSim's aircraft with JSBSim itself: brings its Python package (scripts/python-tools.sh), lets it fly
# every aircraft once, and fails if forces, masses, thrust or flight control come out otherwise.
set -eu
cd "$(dirname "$0")/../.."

scripts/python-tools.sh
python=$(pwd)/target/python/bin/python
recorded=$(pwd)/target/jsbsim

[ -n "$(ls "$recorded" 2>/dev/null)" ] || "$python" scripts/jsbsim/record.py "$recorded"
# Said by name, so that the tests fail where they would otherwise be skipped.
PHUGOID_JSBSIM=$("$python" -c 'import jsbsim, os; print(os.path.dirname(jsbsim.__file__))') \
PHUGOID_JSBSIM_RECORDED=$recorded \
    cargo test --workspace --locked --test integration -- jsbsim
