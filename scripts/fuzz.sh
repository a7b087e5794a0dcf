#!/bin/sh
# Fuzzes every reader of files and of telemetry, one after the other: scripts/fuzz.sh [MINUTES PER TARGET] [TARGET ...]; six
# minutes, an hour in all, if not said otherwise. It begins with the files of the tests and fuzz/seeds, fails at the first crash
# or at more than 200 MB, and leaves what it found below fuzz/artifacts. Without a sanitizer: it would hide how much memory a
# reader takes behind its own.
#
# Needs a nightly compiler (rustup toolchain install nightly) and cargo-fuzz (cargo install cargo-fuzz).
set -eu
cd "$(dirname "$0")/.."

minutes=${1:-6}
[ $# -gt 0 ] && shift
if [ $# -eq 0 ]; then
    set -- csv_reader ulog dataflash matlab parquet arrow mcap model_file daveml telemetry recording jsbsim
fi

command -v cargo-fuzz >/dev/null 2>&1 || { echo "fuzz: cargo-fuzz is not found: cargo install cargo-fuzz" >&2; exit 1; }
cargo +nightly --version >/dev/null 2>&1 || { echo "fuzz: no nightly compiler: rustup toolchain install nightly" >&2; exit 1; }

for target in "$@"; do
    seeds=fuzz/corpus/$target
    mkdir -p "$seeds"
    dictionary=
    [ "$target" != csv_reader ] || dictionary=-dict=fuzz/dictionaries/csv.dict
    [ "$target" != model_file ] || cp data/models/*.toml "$seeds"
    [ "$target" != jsbsim ] || cp crates/phugoid-aircraft/tests/integration/jsbsim/*.xml "$seeds"
    for folder in "fuzz/seeds/$target" "crates/phugoid-flight-data/tests/data/$target"; do
        [ ! -d "$folder" ] || cp "$folder"/* "$seeds"
    done
    echo "fuzz: $target, $minutes minutes"
    nice -n 19 cargo +nightly fuzz run --sanitizer none "$target" "$seeds" -- -max_total_time="$((60 * minutes))" -rss_limit_mb=200 \
        -malloc_limit_mb=200 -max_len=65536 -timeout=20 -print_final_stats=1 $dictionary
done
