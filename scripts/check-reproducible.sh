#!/usr/bin/env bash
# Builds the program twice from the committed sources, in folders with different names, and compares the two files byte
# by byte. Takes two full builds (minutes) and about 2 GB in the folder for temporary files.
#
#   scripts/check-reproducible.sh                     the program as it is released: --profile dist -p phugoid-cli
#   scripts/check-reproducible.sh CARGO-OPTION...     something else that `cargo build` makes, for instance
#                                                     --profile quick -p phugoid-flight-data --example describe
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

options=("$@")
[ ${#options[@]} -gt 0 ] || options=(--profile dist -p phugoid-cli)

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_INCREMENTAL=0
unset CARGO_TARGET_DIR
# A compiler's own variables would differ from one user to the next.
unset CARGO_ENCODED_RUSTFLAGS

# Builds in this folder and prints the place of the file that was made.
build() {
    mkdir -p "$1"
    git archive HEAD | tar -x -C "$1"
    # Messages of panics and the debugging lines hold places of sources: here those of nobody's computer.
    RUSTFLAGS="--remap-path-prefix=$1=/phugoid --remap-path-prefix=${CARGO_HOME:-$HOME/.cargo}=/cargo" \
        cargo build --quiet --locked --manifest-path "$1/Cargo.toml" --message-format json "${options[@]}" |
        sed -n 's/.*"executable":"\([^"]*\)".*/\1/p' | tail -n 1
}

first=$(build "$work/a")
second=$(build "$work/another-folder/with-a-longer-name")
[ -f "$first" ] && [ -f "$second" ] || { echo "reproducible: nothing that runs was built" >&2; exit 1; }
sha256sum "$first" "$second"
if cmp "$first" "$second"; then
    echo "reproducible: both builds are the same, byte by byte"
else
    echo "reproducible: the builds differ" >&2
    exit 1
fi
