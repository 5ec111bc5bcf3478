#!/bin/sh
# BUILD/report.html in headless Chromium: no error in the console, every picture there, controls that work, no sideways
# scroll at 380 px and 1200 px; pictures of both themes, of the narrow page and of paper in BUILD/page.
# usage: check.sh BUILD
set -eu
build=$1 here=$(dirname "$0") work=$(cd "$1/page" && pwd)
sh "$here/../../tests/setup.sh" chromium-headless-shell
{
    echo '<script>window.failures = []; addEventListener("error", (e) => failures.push(e.message));'
    echo 'console.error = (...all) => failures.push(all.join(" "));</script>'
    cat "$build/report.html"
    echo '<script>'; cat "$here/check.js"; echo '</script>'
} >"$work/check.html"
chromium() { chromium-headless-shell --no-sandbox --disable-gpu --hide-scrollbars --virtual-time-budget=20000 "$@" 2>"$work/chromium.log"; }
status=0
for width in 380 1200; do
    title=$(chromium --window-size=$width,800 --dump-dom "file://$work/check.html" | sed -n 's|.*<title>\(.*\)</title>.*|\1|p' | head -1)
    echo "check   report.html, $width px: $title"
    [ "$title" = RIGHT ] || status=1
    if grep 'CONSOLE' "$work/chromium.log"; then status=1; fi
done
page=file://$work/../report.html
chromium --window-size=380,8000 --screenshot="$work/narrow.png" "$page"
chromium --window-size=1200,5000 --screenshot="$work/light.png" "$page"
chromium --window-size=1200,5000 --blink-settings=preferredColorScheme=0 --screenshot="$work/dark.png" "$page"
chromium --no-pdf-header-footer --print-to-pdf="$work/paper.pdf" "$page"
echo "see     $build/page/narrow.png light.png dark.png paper.pdf"
exit $status
