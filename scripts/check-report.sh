#!/usr/bin/env bash
# Opens a report page in headless Chromium and fails if the page logs an error, asks for anything outside itself, draws
# nothing, is wider than a telephone or a screen, or has figures over the time that do not zoom; and the same page without
# its script, which has to show as much. Usage: scripts/check-report.sh REPORT.html [SCREENSHOT.png]
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

"$(dirname "$0")/check-width.sh" "$page" 390 1100 1900 || { echo "check-report: $1 has to be scrolled sideways (above)" >&2; exit 1; }

zooms=
if grep -q '<g class="plot"' "$page" && grep -q '<script>' "$page"; then
  # A page around the report presses its buttons, draws over a figure, and looks at what becomes of curves, ticks and labels.
  { echo "<!doctype html><body><iframe src=\"file://$page\" style=\"width:1100px;height:900px;border:0\"></iframe>"; cat <<'HTML'
<script>
onload = () => {
  const frame = document.querySelector("iframe"), page = frame.contentDocument, told = [];
  const must = (words, holds) => told.push(`${holds ? "holds" : "FAILS"}: ${words}`);
  const plots = [...page.querySelectorAll("svg g.plot")];
  const drawings = new Set(plots.map((plot) => plot.ownerSVGElement));
  const bars = [...page.querySelectorAll(".zoom")];
  const state = () => plots.map((plot) => plot.innerHTML).join() + [...page.querySelectorAll("g.labels")].map((g) => g.innerHTML).join();
  const press = (name) => bars[0].querySelector(`[aria-label="${name}"]`).click();
  const says = () => bars.map((bar) => bar.querySelector("span").textContent);
  const whole = state(), before = says();
  must(`one row of buttons for each of ${drawings.size} figures`, bars.length === drawings.size && bars.length > 0);
  press("Enlarge the middle");
  const enlarged = state();
  const key = plots[0].dataset.time;
  const alike = plots.filter((plot) => plot.dataset.time === key);
  must("all figures of the same time move", alike.every((plot) => plot.getAttribute("clip-path")));
  must("the span is said", says()[0] !== before[0]);
  const [first, last] = key.split(" ").map(Number);
  const labels = [...page.querySelectorAll("g.labels")][0].querySelectorAll("text");
  const shown = [...labels].map((label) => Number(label.textContent.replace("\u2212", "-")));
  const quarter = (last - first) / 4;
  must("the labels are times of the part", shown.length > 1 && shown.every((t) => t >= first + quarter - 1e-6 && last - quarter + 1e-6 >= t));
  press("Later");
  must("later is another part", state() !== enlarged);
  press("Show the whole time");
  must("the whole is as it was", state() === whole && says()[0] === before[0]);
  // The middle fifth of the first panel, drawn with the mouse.
  const svg = plots[0].ownerSVGElement, [left, top, right] = plots[0].dataset.frame.split(" ").map(Number);
  const box = svg.getBoundingClientRect(), scale = box.width / svg.viewBox.baseVal.width;
  const at = (share, type) => svg.dispatchEvent(new frame.contentWindow.PointerEvent(type, {
    clientX: box.left + (left + share * (right - left)) * scale, clientY: box.top + (top + 20) * scale, button: 0, pointerType: "mouse", bubbles: true }));
  at(0.4, "pointerdown"); at(0.5, "pointermove"); at(0.6, "pointerup");
  const part = says()[0].match(/[\d.]+/g).map(Number);
  const near = (a, b) => 0.01 * (last - first) > Math.abs(a - b);
  must(`a part that is drawn is enlarged (${says()[0]})`, near(part[0], first + 0.4 * (last - first)) && near(part[1], first + 0.6 * (last - first)));
  svg.dispatchEvent(new frame.contentWindow.MouseEvent("dblclick", { bubbles: true }));
  must("a double click shows the whole", state() === whole);
  document.body.innerHTML = told.map((line) => `<p>zoom ${line}</p>`).join("");
};
</script>
HTML
  } > "$folder/zoom.html"
  chromium --headless --no-sandbox --disable-gpu --no-first-run --allow-file-access-from-files \
    --host-resolver-rules='MAP * ~NOTFOUND' --user-data-dir="$folder/profile" --window-size=1200,1000 \
    --virtual-time-budget=10000 --dump-dom "file://$folder/zoom.html" 2>/dev/null | grep -oE '<p>zoom [^<]*' > "$folder/zoom" || true
  if ! grep -q holds "$folder/zoom" || grep -q FAILS "$folder/zoom"; then
    echo "check-report: the figures of $1 do not zoom as they should:" >&2
    cat "$folder/zoom" >&2
    exit 1
  fi
  zooms=", $(wc -l < "$folder/zoom") checks of its zoom hold"

  # Without its script the page shows as much.
  sed '/^<script>$/,/^<\/script>/d' "$page" > "$folder/bare.html"
  if grep -q '<script' "$folder/bare.html"; then echo "check-report: $1 has more than one script" >&2; exit 1; fi
  chromium --headless --no-sandbox --disable-gpu --no-first-run --host-resolver-rules='MAP * ~NOTFOUND' \
    --user-data-dir="$folder/profile" --window-size=1200,6000 --screenshot="$folder/bare.png" "file://$folder/bare.html" \
    >/dev/null 2>&1
  bare=$(stat -c %s "$folder/bare.png")
  if [ "$bare" -lt $((bytes * 8 / 10)) ]; then
    echo "check-report: $1 draws much less without scripts ($bare bytes of PNG, $bytes with)" >&2
    exit 1
  fi
fi
echo "check-report: $1 opens without errors ($bytes bytes of PNG)$zooms"
