#!/bin/sh
# Fails where `cargo run --release` compiles a library again that `cargo test --release --workspace` has compiled: tests and program
# are one build as long as their libraries have the same features (crates/phugoid-cli/Cargo.toml). To be run after the tests.
set -eu
cd "$(dirname "$0")/.."

# In two steps, so that a build that fails ends here.
built=$(cargo build --quiet --locked --release --message-format=json)
again=$(printf "%s\n" "$built" |
    sed -n 's/.*"reason":"compiler-artifact".*"target":{[^}]*"name":"\([^"]*\)".*"features":\(\[[^]]*\]\).*"fresh":false.*/\1 \2/p')
if [ -n "$again" ]; then
    echo "one build: compiled once more for the program, for the tests had other features of these, or of what these need:" >&2
    echo "$again" >&2
    echo "one build: cargo tree --workspace --edges features --invert NAME says who asks for a feature" >&2
    exit 1
fi
echo "one build: the program has the libraries of the tests"
