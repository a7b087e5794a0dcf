#!/bin/sh
# Runs the examples of the library and of the bare estimators; each asserts what it claims.
set -eu
cd "$(dirname "$0")/.."

# Of the whole workspace, as the tests have built them: of one crate alone its libraries have other features, and all would be
# built once more.
cargo build --quiet --locked --release --workspace --examples

for example in quick_start own_model_file live_session any_log_to_columns monte_carlo input_design own_plant own_estimator; do
    echo "example $example:"
    "${CARGO_TARGET_DIR:-target}/release/examples/$example"
done
