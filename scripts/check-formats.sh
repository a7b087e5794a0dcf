#!/bin/sh
# Checks what is off by default: the readers of workbooks, Parquet, Arrow and MCAP with their tests, and all round trips.
set -eu
cd "$(dirname "$0")/.."

scripts/optional.py test phugoid-flight-data
scripts/round-trips.sh
