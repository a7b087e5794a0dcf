#!/usr/bin/env bash
# Makes what a release has for one kind of machine: the program in an archive, the Python wheel, the parts list, check sums.
# .github/workflows/release.yml runs it on each system; it runs on a desk just as well.
#
#   scripts/release.sh version                        prints the version, after a check that it is the same everywhere
#   scripts/release.sh program [--built PROGRAM]      phugoid-VERSION-TARGET.tar.gz (.zip on Windows) and its parts list
#   scripts/release.sh wheel                          the wheel for every Python from 3.9 on (needs maturin)
#   scripts/release.sh sums                           SHA256SUMS of all that is there
#
# Everything goes to target/release-files, or to the folder in $RELEASE_FILES. With --built the program is not built but
# taken as it is: to try the packing. In $GITHUB_REF_NAME, where it is set, stands the tag, which has to be `v` and the version.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

out=${RELEASE_FILES:-target/release-files}
# Every format, fleets, FMUs and the terminal view: what ships does all that the documentation says.
features=all-formats,fleet,fmu,tui

fail() { echo "release: $*" >&2; exit 1; }

version() {
    local program package
    program=$(sed -n '/^\[workspace.package\]/,/^\[/s/^version = "\(.*\)"/\1/p' Cargo.toml)
    package=$(sed -n '/^\[package\]/,/^\[/s/^version = "\(.*\)"/\1/p' bindings/python/Cargo.toml)
    [ -n "$program" ] || fail "Cargo.toml has no version under [workspace.package]"
    [ "$program" = "$package" ] || fail "the program is $program and the Python package $package: make them the same"
    case ${GITHUB_REF_TYPE:-} in
    tag) [ "$GITHUB_REF_NAME" = "v$program" ] || fail "the tag is $GITHUB_REF_NAME and the version $program: one is wrong" ;;
    esac
    grep -q "^## \[$program\]" CHANGELOG.md || [ "${GITHUB_REF_TYPE:-}" != tag ] \
        || fail "CHANGELOG.md has no heading '## [$program]': move what stands under [Unreleased] there"
    echo "$program"
}

program() {
    local built="" target version ending library name archive
    if [ "${1:-}" = --built ]; then built=${2:?--built needs the program}; fi
    version=$(version)
    target=$(rustc -vV | sed -n 's/^host: //p')
    ending=; case $target in *windows*) ending=.exe ;; esac
    # What runs in FMUs: `phugoid export-fmu` looks for it beside the program.
    case $target in
    *windows*) library=phugoid_fmi.dll ;;
    *darwin*) library=libphugoid_fmi.dylib ;;
    *) library=libphugoid_fmi.so ;;
    esac
    if [ -z "$built" ]; then
        cargo build --locked --profile dist -p phugoid-cli -p phugoid-fmi --features "phugoid-cli/${features//,/,phugoid-cli/}"
        built=${CARGO_TARGET_DIR:-target}/dist/phugoid$ending
    fi
    [ "$("$built" --version)" = "phugoid $version" ] || fail "$built says '$("$built" --version)', not 'phugoid $version'"
    mkdir -p "$out"
    name=phugoid-$version-$target
    scripts/sbom.py --features "$features" --target "$target" --out "$out/$name.cdx.json"
    case $target in *windows*) archive=$out/$name.zip ;; *) archive=$out/$name.tar.gz ;; esac
    local folder; folder=$(mktemp -d)
    cp "$built" "$folder/phugoid$ending"
    local packed=("$folder/phugoid$ending")
    if [ -f "$(dirname "$built")/$library" ]; then
        packed+=("$(dirname "$built")/$library")
    else
        echo "release: no $library beside $built: the archive is without it" >&2
    fi
    scripts/pack.py "$archive" "$name" "${packed[@]}" README.md CHANGELOG.md SECURITY.md LICENSE-APACHE LICENSE-MIT "$out/$name.cdx.json"
    # What was packed is what a user unpacks: it has to run, with nothing of this folder beside it.
    case $archive in
    *.zip) python3 -c 'import sys, zipfile; zipfile.ZipFile(sys.argv[1]).extractall(sys.argv[2])' "$archive" "$folder" ;;
    *) tar -xzf "$archive" -C "$folder" ;;
    esac
    (cd "$folder/$name" && "./phugoid$ending" estimate --list-models >/dev/null) || fail "$archive: the program in it does not run"
    rm -rf "$folder"
    echo "release: $archive"
}

wheel() {
    local python=${PYTHON:-python3}
    version >/dev/null
    mkdir -p "$out"
    # On Linux maturin names the wheel by the oldest glibc that it runs with, and refuses one that needs more than it says.
    "$python" -m maturin build --release --locked --manifest-path bindings/python/Cargo.toml --out "$out"
}

sums() {
    scripts/pack.py --sums "$out"
    scripts/pack.py --verify "$out"
    echo "release: $out/SHA256SUMS, $(wc -l < "$out/SHA256SUMS") files"
}

case ${1:-} in
version) version ;;
program) program "${@:2}" ;;
wheel) wheel ;;
sums) sums ;;
*) sed -n '2,/^set/s/^# \{0,1\}//p' "$0" >&2; exit 2 ;;
esac
