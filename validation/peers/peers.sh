#!/bin/bash
# Repose against LAMMPS and LIGGGHTS on the same scene, from the same initial positions: a table on standard output.
# usage: peers.sh REPOSE WORK SETTLED FLOWING PAIRS   the sizes as lists in one word: "400 1600"
#
# Each ratio is the median of paired runs of processor time on one core; each round runs repose between the peers, so
# that a busy machine slows all. At rest and flowing the time is that of the timed steps alone, 2000 steps
# after the start; for a sample that of the whole process. Particle-steps are summed over the grains present at each
# step (in the peers every 50th). A missing peer has nan, and a note.
set -eu -o pipefail
shopt -s inherit_errexit
export LC_ALL=C OMP_NUM_THREADS=1
repose=$(realpath "$1") work=$2 settled=$3 flowing=$4 pairs=$5
here=$(realpath "$(dirname "$0")")
[ "$(id -u)" != 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
pin=
if command -v taskset >/dev/null; then pin="taskset -c $(($(nproc) - 1))"; fi
mkdir -p "$work"
cd "$work"

. "$here/start.sh"

# Data files of the peers from a table of grains, all digits. LIGGGHTS' file has densities that give its disks the masses
# of spheres, and a second type for walls.
data() { # NAME N
    local peer types density W
    W=$(width "$2")
    for peer in lammps liggghts; do
        if [ $peer = liggghts ]; then types=2 density='4 * $3 / 3'; else types=1 density=1; fi
        columns x y r <"$1_$2.tsv" | awk '{ printf "%d 1 %.17g %.17g %s %s 0\n", NR, 2 * $3, '"$density"', $1, $2 }' >atoms
        {
            printf 'grains\n\n%d atoms\n%d atom types\n' "$(wc -l <atoms)" $types
            printf '0 %s xlo xhi\n0 %s ylo yhi\n-0.2 0.2 zlo zhi\n\nAtoms # sphere\n\n' "$W" "$(awk "BEGIN { printf \"%.17g\", 2 * $W + 1 }")"
            cat atoms
        } >"$1_$2.$peer"
    done
}

# Particle-steps of the timed steps of a peer, from its log: the trapezoids of lines "step atoms".
grain_steps() {
    sed -n '/^timed/,$p' "$1" | grep -E '^ *[0-9]+ +[0-9]+ *$' |
        awk 'NR > 1 { sum += ($1 - step) * ($2 + atoms) / 2 } { step = $1; atoms = $2 } END { print sum }'
}

# seconds of processor time of a whole process
seconds() { (TIMEFORMAT='%U %S'; { time "$@" >process.log; } 2>&1) | tail -1 | awk '{ print $1 + $2 }'; }

# For each program, by state, N and steps: million particle-steps per second of processor time; for a sample seconds.
measure_ours() {
    if [ "$1" = sample ]; then
        seconds $pin "$repose" bench --start "dilute_$2.tsv" --state sample --floor absorbs --repeat 1 -o final.tsv
    else
        $pin "$repose" bench --start "settled_$2.tsv" --state "$1" --floor absorbs --steps "$3" --repeat 1 | columns median
    fi
}
measure_lammps() {
    if [ "$1" = sample ]; then
        seconds $pin lmp -in "$here/box.in" -log none -v data "dilute_$2.lammps" -v state sample -v final final.dump
    else
        $pin lmp -in "$here/box.in" -log none -v data "settled_$2.lammps" -v state "$1" -v warm 2000 -v steps "$3" >lmp.log
        sed -n '/^timed/,$p' lmp.log | sed -n 's/^Loop time of \([^ ]*\) .*/\1/p; s/^\([^ ]*\)% CPU use.*/\1/p' | head -2 |
            paste -s | awk -v sum="$(grain_steps lmp.log)" '{ print sum / ($1 * $2 / 100) / 1e6 }'
    fi
}
# LIGGGHTS does not report processor time: a shell that it starts reads that of its parent, ns.
stamp='read -r ns rest </proc/$PPID/schedstat; echo stamp $ns >&2'
measure_liggghts() {
    if [ "$1" = sample ]; then
        seconds $pin liggghts -in "$here/box_liggghts.in" -log none -var data "dilute_$2.liggghts" -var state sample \
            -var final final.dump
    else
        $pin liggghts -in "$here/box_liggghts.in" -log none -var data "settled_$2.liggghts" -var state "$1" \
            -var warm 2000 -var steps "$3" -var stamp "$stamp" >liggghts.log 2>stamps.log
        awk -v sum="$(grain_steps liggghts.log)" '/^stamp/ { if (n++) print sum / ($2 - first) * 1e3; first = $2 }' stamps.log
    fi
}

# Values of a program, one a round, from lines "program value".
values() { sed -n "s/^$1 //p" rounds; }

# Median of a peer and of our ratios to it, with the smallest and the largest; nan where there is no such program.
compared() { # peer, columns of the ratio's numerator and denominator among "ours peer"
    if [ -z "$(values "$1")" ]; then printf '\tnan\tnan\tnan\tnan'; return; fi
    paste <(values ours) <(values "$1") | awk "{ print \$$2 / \$$3 }" | sort -g >ratios
    printf '\t%s' "$(values "$1" | median)" "$(median <ratios)" "$(head -1 ratios)" "$(tail -1 ratios)"
}

row() { # state N steps
    local order='1 2'
    if [ "$1" = sample ]; then order='2 1'; fi # seconds, no rates
    printf '%s\t%s\t%s\t%s\t%s' "$1" "$2" "$3" "$(values ours | wc -l)" "$(values ours | median)"
    compared lammps $order
    compared liggghts $order
    echo
}

compare() { # state N
    local steps=$((20000000 / $2)) k program value
    if [ "$1" = flowing ] && [ $steps -gt 10000 ]; then steps=10000; fi
    if [ "$1" = sample ]; then steps=80000; fi
    for k in $(seq "$pairs"); do
        for program in $programs; do
            value=$(measure_$program "$1" "$2" $steps)
            echo "$program $value"
        done
    done >rounds
    row "$1" "$2" $steps
}

provenance
echo "# repose, lammps, liggghts: 1e6 particle-steps per second of processor time, medians; for a sample seconds of the process"
echo "# ratio: rate of repose over that of the peer, median of the pairs, with the smallest (min) and the largest (max)"
programs=ours
if ! command -v lmp >/dev/null; then echo "# lammps: not installed"; else
    echo "# lammps: $(lmp -h | sed -n 's/.*Simulator - \(.*\)/\1/p')"
    programs="lammps $programs"
fi
if ! command -v liggghts >/dev/null; then echo "# liggghts: not installed"; else
    echo "# liggghts: $(liggghts -h | sed -n 's/.*Version LIGGGHTS-PUBLIC \([^,]*\),.*/\1/p')"
    programs="$programs liggghts"
fi
printf '# units: \t\t\t\t1e6/s\t1e6/s\t\t\t\t1e6/s\t\t\t\n'
printf 'state\tgrains\tsteps\tpairs\trepose\tlammps\tlammps_ratio\tlammps_min\tlammps_max'
printf '\tliggghts\tliggghts_ratio\tliggghts_min\tliggghts_max\n'
for n in $(printf '%s\n' $settled $flowing | sort -un); do
    settle "$n"
    data settled "$n"
done
for n in $settled; do compare settled "$n"; done
for n in $flowing; do compare flowing "$n"; done
dilute 400
data dilute 400
compare sample 400
