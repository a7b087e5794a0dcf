#!/bin/sh
# Installs Debian packages: scripts/debian-install.sh PACKAGE ... Says what is missing where it cannot.
set -eu

if ! command -v apt-get >/dev/null 2>&1; then
    echo "debian-install: not found: $*; this script installs with apt-get, which is not here either." >&2
    echo "Install them with your system's package manager." >&2
    exit 1
fi
if [ "$(id -u)" -eq 0 ]; then
    sudo=
elif command -v sudo >/dev/null 2>&1; then
    sudo="sudo env DEBIAN_FRONTEND=noninteractive"
else
    echo "debian-install: not found: $*; installing needs root: run as root, or install sudo." >&2
    exit 1
fi

# apt must not ask, nor bring what is only recommended.
export DEBIAN_FRONTEND=noninteractive
$sudo apt-get update -qq
$sudo apt-get install -y -qq --no-install-recommends "$@"
echo "debian-install: installed $*"
