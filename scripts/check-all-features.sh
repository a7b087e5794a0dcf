#!/bin/sh
# Checks the program with every feature, what .ci/run has no time for: to be run where one of them changes, and before a release.
set -eu
cd "$(dirname "$0")/.."

cargo clippy -p phugoid-cli --all-features --all-targets --locked -- -D warnings
cargo test -p phugoid-cli --all-features --locked --test integration inspect::
