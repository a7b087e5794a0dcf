#!/bin/sh
# Makes a Python environment with the formats' own tools, at pinned versions, for the round trips: in target/python, or in
# the folder given; other packages where their list is given too. Does nothing, and needs no network, where it is there already.
set -eu
cd "$(dirname "$0")/.."

folder=${1:-target/python}
requirements=${2:-tests/python/requirements.txt}

if [ -x "$folder/bin/python" ] && cmp -s "$requirements" "$folder/requirements.txt"; then
    echo "python-tools: $folder is there"
    exit 0
fi

command -v python3 >/dev/null 2>&1 || { echo "python-tools: python3 is not found; install Python 3.11 or newer" >&2; exit 1; }

# Debian keeps ensurepip, which venv needs, in a package of its own.
python3 -c 'import ensurepip, venv' >/dev/null 2>&1 || scripts/debian-install.sh python3-venv

rm -rf "$folder"
python3 -m venv "$folder"
"$folder/bin/pip" install --quiet --disable-pip-version-check --requirement "$requirements"
# Last, so that an environment that was only half made is made again.
cp "$requirements" "$folder/requirements.txt"
echo "python-tools: made $folder"
