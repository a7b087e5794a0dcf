#!/bin/sh
# Checks all dependencies against the RustSec advisory database: known vulnerabilities, crates without a maintainer,
# yanked versions as far as the database knows them. Needs no network: the database is a snapshot, a tar file
# `advisories/advisory-db-DATE.tar.gz` in PHUGOID_SHARED_DATA or ../shared/data, unpacked to a temporary folder. Without
# it one line says that the check is skipped; where CI is set its absence is a failure. Newer advisories are not in a
# snapshot: before a release run `cargo deny check advisories`, which fetches the database of the day.
set -eu
cd "$(dirname "$0")/.."

folder=${PHUGOID_SHARED_DATA:-../shared/data}/advisories
snapshot=$(find "$folder" -name 'advisory-db-*.tar.gz' 2>/dev/null | sort | tail -n 1)
if [ -z "$snapshot" ]; then
    echo "skipped: no snapshot of the advisory database in $folder; set PHUGOID_SHARED_DATA to the shared data"
    [ -z "${CI:-}" ]
    exit
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# cargo-deny takes the database from a git repository only, and without a network from the folder into which it would
# have fetched https://github.com/rustsec/advisory-db.
database=$work/advisory-db-3157b0e258782691
mkdir "$database"
tar -xzf "$snapshot" -C "$database"
git -C "$database" init --quiet
git -C "$database" add --all
git -C "$database" -c user.name=snapshot -c user.email=snapshot@example.invalid commit --quiet --message snapshot
sed "s|^\[advisories\]\$|&\ndb-path = \"$work\"|" deny.toml > "$work/deny.toml"
grep -q '^db-path' "$work/deny.toml"
cargo deny --locked --offline --config "$work/deny.toml" check --hide-inclusion-graph advisories
echo "checked against $(basename "$snapshot" .tar.gz)"
