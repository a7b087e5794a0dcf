#!/bin/sh
# Builds the Python package as a wheel, installs it into the environment of scripts/python-tools.sh, and runs its tests, its
# example and its type check.
#
#     scripts/check-python.sh [wheel]        only the wheel
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh
python=$(pwd)/target/python/bin/python

# Optimised a little: with nothing optimised the build takes a minute less, and the tests and the example take five minutes more.
# What is checked is the package, not the speed; a release wheel is `maturin build --release`.
CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$(pwd)/target}/python-wheel
CARGO_PROFILE_DEV_OPT_LEVEL=1
CARGO_PROFILE_DEV_DEBUG=0
CARGO_INCREMENTAL=0
export CARGO_TARGET_DIR CARGO_PROFILE_DEV_OPT_LEVEL CARGO_PROFILE_DEV_DEBUG CARGO_INCREMENTAL

rm -rf target/wheels
"$python" -m maturin build --quiet --locked --manifest-path bindings/python/Cargo.toml --interpreter "$python" --out target/wheels
[ "${1:-}" != wheel ] || exit 0
"$python" -m pip install --quiet --disable-pip-version-check --force-reinstall --no-deps target/wheels/phugoid-*.whl
"$python" -m pytest -q -p no:cacheprovider bindings/python/tests
echo "the example:"
"$python" bindings/python/examples/estimate_f16.py
"$python" -m mypy --config-file bindings/python/pyproject.toml --cache-dir target/mypy bindings/python/python/phugoid
# The stub says of the native module what is there: every name, every parameter and its default.
cd target
MYPY_CACHE_DIR=mypy "$python" -m mypy.stubtest phugoid._phugoid --concise --mypy-config-file ../bindings/python/pyproject.toml
