#!/bin/sh
# Checks a small fleet and a small campaign: killed at any moment and started again, in shards, and the questions of
# docs/fleet.md asked of their stores by DuckDB.
set -eu
cd "$(dirname "$0")/.."

scripts/python-tools.sh
scripts/optional.py test phugoid-fleet
# The tests of the program leave their stores where this says.
PHUGOID_FLEET_STORES=$(mktemp -d)
export PHUGOID_FLEET_STORES
trap 'rm -rf "$PHUGOID_FLEET_STORES"' EXIT
scripts/optional.py test phugoid-cli fleet:: kept_runs::
target/python/bin/python scripts/ask-fleet.py docs/fleet.md "$PHUGOID_FLEET_STORES/fleet" "$PHUGOID_FLEET_STORES/study"
