#!/bin/sh
# Installs what the checks need beyond Rust: cargo-deny (licences, duplicate dependencies) from crates.io, and on Debian
# Chromium, to render report pages. Does nothing, and needs no network and no rights, where everything is there already.
#
#   scripts/install-tools.sh                both
#   scripts/install-tools.sh cargo-deny     one of them: cargo-deny is compiled, Chromium is downloaded
#   scripts/install-tools.sh chromium
set -eu

[ $# -gt 0 ] || set -- cargo-deny chromium

for tool in "$@"; do
    if command -v "$tool" >/dev/null 2>&1; then
        echo "install-tools: $tool is there"
        continue
    fi
    case $tool in
    # Without optimisation: it looks at a few hundred names, and its release profile (one unit per crate, optimised across all
    # crates) takes minutes to compile.
    cargo-deny) CARGO_PROFILE_DEV_DEBUG=false cargo install --debug --locked --version 0.20.2 cargo-deny ;;
    chromium) "$(dirname "$0")/debian-install.sh" chromium ;;
    *) echo "install-tools: $tool is none of the tools" >&2; exit 1 ;;
    esac
    command -v "$tool" >/dev/null 2>&1 || { echo "install-tools: $tool is still missing after installing it" >&2; exit 1; }
done
