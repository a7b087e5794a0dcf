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

missing=
command -v chromium >/dev/null 2>&1 || missing="$missing chromium"

if [ -z "$missing" ]; then
    echo "install-tools: Chromium is there"
    exit 0
fi
if ! command -v apt-get >/dev/null 2>&1; then
    echo "install-tools: not found:$missing; this script installs with apt-get, which is not here either." >&2
    echo "Install them with your system's package manager." >&2
    exit 1
fi

if [ "$(id -u)" -eq 0 ]; then
    sudo=
elif command -v sudo >/dev/null 2>&1; then
    sudo="sudo env DEBIAN_FRONTEND=noninteractive"
else
    echo "install-tools: not found:$missing; installing needs root: run as root, or install sudo." >&2
    exit 1
fi

export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
# Each word of $missing is a package; apt must not ask, nor bring what is only recommended.
# shellcheck disable=SC2086
$sudo apt-get install -y -qq --no-install-recommends $missing

for tool in $missing; do
    command -v "$tool" >/dev/null 2>&1 || { echo "install-tools: $tool is still missing after installing it" >&2; exit 1; }
done
echo "install-tools: installed$missing"
