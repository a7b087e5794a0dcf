#!/bin/sh
# The exported parameters of Gazebo's AdvancedLiftDrag, parsed by libsdformat and read as the plugin reads them.
# Needs a C++ compiler and libsdformat 12 (Debian 12: apt-get install libsdformat-dev); not part of the checks that always run.
set -eu
cd "$(dirname "$0")/.."

if ! pkg-config --exists sdformat12; then
    echo "SDF: no libsdformat 12; on Debian 12: apt-get install libsdformat-dev" >&2
    exit 2
fi
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT

# shellcheck disable=SC2046
c++ -std=c++17 scripts/sdf/read_plugin.cpp -o "$folder/read_plugin" $(pkg-config --cflags --libs sdformat12)
cargo build --quiet --locked --release -p phugoid-identification --example export_model
model=data/models/hfb320.toml
{
    echo '<?xml version="1.0"?><sdf version="1.9"><model name="aircraft"><link name="base_link"/>'
    "${CARGO_TARGET_DIR:-target}/release/examples/export_model" "$model" gazebo
    echo '</model></sdf>'
} > "$folder/aircraft.sdf"
"$folder/read_plugin" "$folder/aircraft.sdf" > "$folder/read.txt"
echo "SDF: $model: $(wc -l < "$folder/read.txt") values read by libsdformat"
