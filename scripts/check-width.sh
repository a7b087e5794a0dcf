#!/usr/bin/env bash
# Fails where a page in headless Chromium is wider than its window, so that it would have to be scrolled sideways.
# Usage: scripts/check-width.sh PAGE.html WIDTH..., px
set -euo pipefail

page=$(realpath "$1")
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# No window of Chromium is narrower than 500 px: the page stands in frames of the widths, and a script outside it measures them.
{
    echo '<!doctype html><body>'
    for width in "$@"; do echo "<iframe src=\"file://$page\" style=\"width:${width}px;height:900px;border:0\"></iframe>"; done
    cat <<'HTML'
<script>
onload = () => {
  for (const frame of document.querySelectorAll("iframe")) {
    const wide = frame.contentDocument.documentElement.scrollWidth, width = frame.clientWidth;
    const told = document.createElement("p");
    told.textContent = `width ${width} page ${wide} ${wide > width ? "TOO WIDE" : "fits"}`;
    document.body.append(told);
  }
};
</script>
HTML
} > "$folder/frames.html"
chromium --headless --no-sandbox --disable-gpu --no-first-run --allow-file-access-from-files \
  --host-resolver-rules='MAP * ~NOTFOUND' --user-data-dir="$folder/profile" --window-size=2000,1000 --virtual-time-budget=5000 \
  --dump-dom "file://$folder/frames.html" 2>"$folder/log" | grep -oE 'width [0-9]+ page [0-9]+ (fits|TOO WIDE)' \
  > "$folder/told" || true
if [ "$(wc -l < "$folder/told")" -ne $# ] || grep -q 'TOO WIDE' "$folder/told"; then
    echo "check-width: $page in windows of $* px:" >&2
    cat "$folder/told" >&2
    exit 1
fi
echo "check-width: $(basename "$page") fits into $* px"
