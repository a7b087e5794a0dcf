#!/bin/sh
# Runs the studies among the tests with all their flights: .ci/run flies some of each.
set -eu
cd "$(dirname "$0")/.."

PHUGOID_WHOLE_STUDIES=1 cargo test --release --workspace --locked --test integration -- \
    accuracy:: batch:: detection:: lateral:: declared_by_default::
