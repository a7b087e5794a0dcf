#!/bin/sh
# Installs what the checks need beyond Rust: cargo-deny (licences, duplicate dependencies) from crates.io, and on Debian
# Chromium, to render report pages.
# Does nothing, and needs no network and no rights, where everything is there already.
set -eu

if command -v cargo-deny >/dev/null 2>&1; then
    echo "install-tools: cargo-deny is there"
else
    cargo install --locked --version 0.20.2 cargo-deny
fi

if command -v chromium >/dev/null 2>&1; then
    echo "install-tools: Chromium is there"
else
    "$(dirname "$0")/debian-install.sh" chromium
    command -v chromium >/dev/null 2>&1 || { echo "install-tools: chromium is still missing after installing it" >&2; exit 1; }
fi
