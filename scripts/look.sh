#!/usr/bin/env bash
# A picture of a page as headless Chromium shows it in a window of this width, without a network.
# Usage: scripts/look.sh PAGE.html WIDTH OUT.png [HEIGHT], px; the height is 6000 where it is not given.
set -euo pipefail

page=$(realpath "$1")
width=$2
height=${4:-6000}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# No window of Chromium is narrower than 500 px: the page stands in a frame of the width.
cat > "$folder/frame.html" <<HTML
<!doctype html><body style="margin:0"><iframe src="file://$page" style="width:${width}px;height:${height}px;border:0"></iframe>
HTML
chromium --headless --no-sandbox --disable-gpu --no-first-run --hide-scrollbars --allow-file-access-from-files \
  --host-resolver-rules='MAP * ~NOTFOUND' --user-data-dir="$folder/profile" --window-size="$((width > 500 ? width : 500)),$height" \
  --screenshot="$3" "file://$folder/frame.html" >/dev/null 2>"$folder/log" || { cat "$folder/log" >&2; exit 1; }
