#!/bin/bash
# Cost of each feature of a scene: instructions per particle-step of the box of 400 grains at rest, counted by
# valgrind's callgrind; a table on standard output. usage: instructions.sh REPOSE WORK
#
# Count of $to steps minus that of $from, so that start and end cancel, for the AVX2 and the baseline kernel,
# since valgrind has no AVX-512.
set -eu -o pipefail
export LC_ALL=C
repose=$(realpath "$1") work=$2 here=$(realpath "$(dirname "$0")")
mkdir -p "$work"
cd "$work"
. "$here/start.sh"

count() { # options of `repose run`
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$repose" run "$@" 2>&1 >counted.tsv |
        sed -n 's/.*Collected : *//p'
}

row() { # words of the row, scene, options
    local name=$1 scene=$2 kernel per=
    shift 2
    for kernel in avx2 baseline; do
        per="$per	$(echo "$(count "$scene" "$@" --set kernel=$kernel --set steps=$to) \
            $(count "$scene" "$@" --set kernel=$kernel --set steps=$from)" | awk -v steps=$((to - from)) '!($1 > $2) { exit 1 } { print ($1 - $2) / steps / 400 }')"
    done
    "$repose" run "$scene" "$@" --set steps=$to | columns step contacts |
        awk -v row="$name$per" -v to=$to '$1 == to { n++; sum += $2 } END { print row "\t" sum / n }'
}

provenance
echo "# contacts: per grain, a contact of two grains counted at both; without walls: fixed grains in place of walls"
printf '# units: \t\t\t\nscene\tavx2\tbaseline\tcontacts\n'
if ! command -v valgrind >/dev/null; then echo "instructions.sh: valgrind is not installed" >&2; exit 0; fi
for scene in box sizes; do
    settle $scene 400
    { box 400 0; echo "normal = { law = \"hertz\"; }; rolling = { mu = 0.0; }; particles_file = \"$start\";"; } >$scene.cfg
done
# grains within 0.2 of the walls, fixed
{ printf 'x\ty\tr\tfixed\n'
  columns x y r <settled_box_400.tsv |
      awk '{ print $1, $2, $3, ($1 < 0.2 || $1 > 3.8 || $2 < 0.2 ? 1 : 0) }' OFS='\t'; } >fixed_400.tsv
echo 'normal = { law = "hertz"; }; tangential = { law = "spring"; mu = 0.2; damping = "outside"; }; particles_file = "fixed_400.tsv";' >fixed.cfg
from=1000 to=1400
row 'all of the box' box.cfg
row 'without friction' box.cfg --set tangential.law=none --set tangential.mu=0
row 'without damping' box.cfg --set normal.gamma_n=0
row 'without walls' fixed.cfg
row 'with rotation' box.cfg --set rotation=true
row 'with rolling resistance' box.cfg --set rotation=true --set rolling.mu=0.05
row 'with radii of 1:10' sizes.cfg --set dt=2e-5
row 'with the energy ledger' box.cfg --ledger
from=10 to=20
row 'with output every step' box.cfg --every 1
