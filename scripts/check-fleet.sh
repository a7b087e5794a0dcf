#!/bin/sh
# Checks a small fleet and a small campaign: killed at any moment and started again, in shards, and the questions of
# docs/fleet.md asked of their stores by DuckDB. Built without optimisation, as scripts/check-formats.sh is.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh
cargo test --quiet --locked --profile quick -p phugoid-fleet --features parquet
# The tests of the program leave their stores where this says.
PHUGOID_FLEET_STORES=$(mktemp -d)
export PHUGOID_FLEET_STORES
trap 'rm -rf "$PHUGOID_FLEET_STORES"' EXIT
cargo test --quiet --locked --profile quick -p phugoid-cli --features fleet --test integration fleet::
target/python/bin/python scripts/ask-fleet.py docs/fleet.md "$PHUGOID_FLEET_STORES/fleet" "$PHUGOID_FLEET_STORES/study"
