#!/bin/sh
# Runs the examples of the library and of the bare estimators; each asserts what it claims.
set -eu
cd "$(dirname "$0")/.."

# One build for each crate, then the programs themselves.
cargo build --quiet --locked -p phugoid --examples
cargo build --quiet --locked -p phugoid-estimators --example own_plant --example own_estimator

for example in quick_start own_model_file live_session any_log_to_columns monte_carlo input_design own_plant own_estimator; do
    echo "example $example:"
    "${CARGO_TARGET_DIR:-target}/debug/examples/$example"
done
