#!/usr/bin/env bash
# Opens a report page in headless Chromium and fails if the page logs an error, asks for anything outside itself, or
# draws nothing. Usage: scripts/check-report.sh REPORT.html [SCREENSHOT.png]
set -euo pipefail

page=$(realpath "$1")
picture=${2:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
[ -n "$picture" ] || picture=$folder/page.png

# Any host name resolves to nothing: a page that needs the network shows it.
chromium --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
  --disable-component-update --disable-sync --host-resolver-rules='MAP * ~NOTFOUND' \
  --enable-logging=stderr --user-data-dir="$folder/profile" --window-size=1200,6000 \
  --screenshot="$picture" "file://$page" >"$folder/log" 2>&1 || { cat "$folder/log" >&2; exit 1; }

if grep -E 'CONSOLE.*(error|Error|Refused|Failed)|ERR_' "$folder/log" >&2; then
  echo "check-report: $1 logs errors in the browser (above)" >&2
  exit 1
fi
if grep -oE '(src|href|url\()="?https?://[^" )]+' "$page" >&2; then
  echo "check-report: $1 refers to the network (above)" >&2
  exit 1
fi
bytes=$(stat -c %s "$picture")
# An empty page of this size compresses to some 20 kB; a report to several hundred.
if [ "$bytes" -lt 100000 ]; then
  echo "check-report: $1 draws next to nothing ($bytes bytes of PNG)" >&2
  exit 1
fi
echo "check-report: $1 opens without errors ($bytes bytes of PNG)"
