#!/bin/sh
# Install those of the named Debian packages that are missing.
missing=
for p; do
    dpkg-query -W -f '${Status}\n' "$p" 2>/dev/null | grep -q 'install ok installed' || missing="$missing $p"
done
[ -n "$missing" ] || exit 0
command -v apt-get >/dev/null || { echo "setup: no apt-get; install what Debian calls$missing" >&2; exit 1; }
if [ "$(id -u)" = 0 ]; then sudo=; elif command -v sudo >/dev/null; then sudo=sudo; else
    echo "setup: as root, run: apt-get install --no-install-recommends$missing" >&2
    exit 1
fi
echo "setup: installing$missing"
$sudo apt-get update -q >/dev/null &&
    $sudo env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing >/dev/null
