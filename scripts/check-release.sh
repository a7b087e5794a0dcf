#!/usr/bin/env bash
# Packs a program as a release does, and fails where the archive is not whole, does not run, or is another one the second
# time, where a changed file is not noticed, or where the workflow calls what is not there.
# Usage: scripts/check-release.sh [PROGRAM], by default target/release/phugoid.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

program=${1:-${CARGO_TARGET_DIR:-target}/release/phugoid}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
fail() { echo "check-release: $*" >&2; exit 1; }

for time in first second; do
    RELEASE_FILES=$folder/$time scripts/release.sh program --built "$program" >/dev/null
    RELEASE_FILES=$folder/$time scripts/release.sh sums >/dev/null
done
cmp "$folder/first/SHA256SUMS" "$folder/second/SHA256SUMS" || fail "the same files make two archives"
(cd "$folder/first" && sha256sum --check --quiet SHA256SUMS) || fail "the check sums are not those that sha256sum makes"
tar -tzf "$folder"/first/phugoid-*.tar.gz > "$folder/list"
grep -q '/LICENSE-MIT$' "$folder/list" || fail "the archive has no licence"
grep -q '"bomFormat": "CycloneDX"' "$folder"/first/*.cdx.json || fail "there is no parts list"
echo changed >> "$folder/second/$(basename "$folder"/first/*.cdx.json)"
if scripts/pack.py --verify "$folder/second" 2>/dev/null; then fail "a changed file is not noticed"; fi
if GITHUB_REF_TYPE=tag GITHUB_REF_NAME=v99.0.0 scripts/release.sh version >/dev/null 2>&1; then
    fail "a tag that is not the version is not noticed"
fi
for script in $(grep -oE 'scripts/[a-z-]+\.(sh|py)' .github/workflows/release.yml | sort -u); do
    [ -x "$script" ] || fail ".github/workflows/release.yml calls $script, which is not there or cannot be run"
done
echo "check-release: $(cd "$folder/first" && ls | wc -l) files, the same twice, whole, and the program in them runs"
