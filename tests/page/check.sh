#!/bin/sh
# The page in headless Chromium. usage: check.sh REPOSE PAGE, its folder
set -eu
command -v node >/dev/null || { echo "check-page: needs node: as root, run: apt-get install nodejs" >&2; exit 1; }
exec node "$(dirname "$0")/check.js" "$@"
