#!/usr/bin/env bash
# Opens the dashboard in headless Chromium on synthetic streams and fails if a state is not told, a key or the mouse does
# not do its work, or the browser logs an error or asks for anything outside the page. Needs python3 and Chromium.
#   scripts/check-dashboard.sh                      the checks
#   scripts/check-dashboard.sh --pictures FOLDER    ... and screenshots of each state
#   scripts/check-dashboard.sh --measure 60         frames per second at 100 Hz with 11 parameters
#   scripts/check-dashboard.sh --memory             memory over 30 minutes of data, fed faster than real time
set -euo pipefail
exec python3 "$(dirname "${BASH_SOURCE[0]}")/dashboard/check.py" "$@"
