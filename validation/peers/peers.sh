#!/bin/bash
# Repose against LAMMPS and LIGGGHTS on the same scenes, from the same initial positions: a table on standard output.
# usage: peers.sh REPOSE WORK ROUNDS [PATTERN]   of the cases below, those whose line the pattern fits
#
# Each ratio is the median of rounds, of processor time on one core; in a round repose runs between the peers, so
# that a busy machine slows all. At rest and flowing the time is that of the timed steps alone, 2000 steps
# after the start; for a sample that of the whole process. Particle-steps are summed over the grains present at each
# step (in the peers every 50th). A missing peer has nan, and a note. Of scene threads all programs use all processors,
# and the time is that of the wall. LIGGGHTS takes no part in it, nor in scene sizes, where its lists of neighbours are
# made for the largest grain.
set -eu -o pipefail
shopt -s inherit_errexit
export LC_ALL=C OMP_NUM_THREADS=1
repose=$(realpath "$1") work=$2 rounds=$3 pattern=${4:-.}
here=$(realpath "$(dirname "$0")")
[ "$(id -u)" != 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
mkdir -p "$work"
cd "$work"
. "$here/start.sh"
pin=
if command -v taskset >/dev/null; then pin="taskset -c $((processors - 1))"; fi

cases='
box settled 400
box settled 1600
box settled 10000
box settled 100000
box flowing 400
box flowing 1600
box flowing 10000
box sample 400
rotation settled 400
rotation settled 1600
rotation settled 10000
rotation flowing 400
rotation flowing 1600
rotation flowing 10000
rolling settled 400
rolling settled 1600
rolling settled 10000
rolling flowing 400
rolling flowing 1600
rolling flowing 10000
sizes settled 10000
sizes flowing 10000
threads settled 100000
threads flowing 100000
threads settled 1000000
'

# Variables of the peers' inputs for a scene.
variables() { # peer scene
    local v=-v
    if [ "$1" = liggghts ]; then v=-var; fi
    case $1\ $2 in
        *rotation) echo $v move nve/sphere ;;
        lammps*rolling) echo $v move nve/sphere $v mu_roll 0.05 ;;
        liggghts*rolling) echo $v move nve/sphere $v mu_roll 0.05 $v rolling epsd ;;
        lammps*sizes) echo $v lists multi ;;
    esac
}

# Data files of the peers from a table of grains, all digits: start.lammps, start.liggghts. That of LIGGGHTS has
# densities that give its disks the masses of spheres, and a second type for walls.
data() { # N
    local peer types density
    for peer in lammps liggghts; do
        if [ $peer = liggghts ]; then types=2 density='4 * $3 / 3'; else types=1 density=1; fi
        columns x y r <"$start" | awk '{ printf "%d 1 %.17g %.17g %s %s 0\n", NR, 2 * $3, '"$density"', $1, $2 }' >atoms
        {
            printf 'grains\n\n%d atoms\n%d atom types\n0 %s xlo xhi\n' "$(wc -l <atoms)" $types "$(width "$1")"
            awk '$6 > top { top = $6 } END { printf "0 %.17g ylo yhi\n", top + 1 }' atoms
            printf -- '-0.2 0.2 zlo zhi\n\nAtoms # sphere\n\n'
            cat atoms
        } >start.$peer
    done
}

# Particle-steps of the timed steps of a peer, from its log: the trapezoids of lines "step atoms".
grain_steps() {
    sed -n '/^timed/,$p' "$1" | grep -E '^ *[0-9]+ +[0-9]+ *$' |
        awk 'NR > 1 { sum += ($1 - step) * ($2 + atoms) / 2 } { step = $1; atoms = $2 } END { print sum }'
}

# seconds of processor time of a whole process
seconds() { (TIMEFORMAT='%U %S'; { time "$@" >process.log; } 2>&1) | tail -1 | awk '{ print $1 + $2 }'; }

# For each program, by scene, state, N and steps: million particle-steps per second of processor time, or of wall time
# for threads; for a sample seconds.
measure_ours() {
    if [ "$2" = sample ]; then
        seconds $alone "$repose" bench --start "$start" --state sample --floor absorbs --repeat 1 -o final.tsv
    else
        $alone "$repose" bench --start "$start" --width "$(width "$3")" $(options "$1") --state "$2" --floor absorbs --steps "$4" \
            --repeat 1 | columns median
    fi
}
measure_lammps() {
    local run="lmp -in $here/box.in -log none -v data start.lammps -v state $2 -v dt $dt $(variables lammps "$1")"
    if [ "$2" = sample ]; then
        seconds $ranks $run -v final final.dump
    else
        $ranks $run -v warm $warm -v steps "$4" >lmp.log
        sed -n '/^timed/,$p' lmp.log | sed -n 's/^Loop time of \([^ ]*\) .*/\1/p; s/^\([^ ]*\)% CPU use.*/\1/p' | head -2 |
            paste -s | awk -v scene="$1" -v sum="$(grain_steps lmp.log)" \
                '{ print sum / ($1 * (scene == "threads" ? 1 : $2 / 100)) / 1e6 }'
    fi
}
# LIGGGHTS does not report processor time: a shell that it starts reads that of its parent, ns.
stamp='read -r ns rest </proc/$PPID/schedstat; echo stamp $ns >&2'
measure_liggghts() {
    local run="liggghts -in $here/box_liggghts.in -log none -var data start.liggghts -var state $2 -var dt $dt $(variables liggghts "$1")"
    if [ "$2" = sample ]; then
        seconds $ranks $run -var final final.dump
    else
        $ranks $run -var warm $warm -var steps "$4" -var stamp "$stamp" >liggghts.log 2>stamps.log
        awk -v sum="$(grain_steps liggghts.log)" '/^stamp/ { if (n++) print sum / ($2 - first) * 1e3; first = $2 }' stamps.log
    fi
}

# Values of a program, one a round, from lines "program value".
values() { sed -n "s/^$1 //p" values; }

# Median of a peer and of our ratios to it, with the smallest and the largest; nan where there is no such program.
compared() { # peer, columns of the ratio's numerator and denominator among "ours peer"
    if [ -z "$(values "$1")" ]; then printf '\tnan\tnan\tnan\tnan'; return; fi
    paste <(values ours) <(values "$1") | awk "{ print \$$2 / \$$3 }" | sort -g >ratios
    printf '\t%s' "$(values "$1" | median)" "$(median <ratios)" "$(head -1 ratios)" "$(tail -1 ratios)"
}

row() { # scene state N steps
    local order='1 2'
    if [ "$2" = sample ]; then order='2 1'; fi # seconds, no rates
    printf '%s\t%s\t%s\t%s\t%s\t%s' "$1" "$2" "$3" "$4" "$(values ours | wc -l)" "$(values ours | median)"
    compared lammps $order
    compared liggghts $order
    echo
}

compare() { # scene state N
    local steps=$((20000000 / $3)) warm=2000 alone=$pin ranks=$pin k program value
    case $2 in
        flowing) if [ $steps -gt 10000 ]; then steps=10000; fi ;;
        sample) steps=80000 ;;
    esac
    if [ "$1" = threads ]; then steps=$((5 * steps)) alone= ranks="mpirun -np $processors"; fi
    if [ "$3" = 1000000 ]; then warm=200; fi # 2000 would take a peer many minutes
    if [ "$2" = sample ]; then dilute "$3"; else settle "$1" "$3"; fi
    data "$3"
    # the time step that repose takes for this start
    dt=$("$repose" bench --start "$start" --width "$(width "$3")" $(options "$1") --steps 1 --repeat 1 | sed -n 's/^# dt: \([^ ]*\) s$/\1/p')
    for k in $(seq "$rounds"); do
        for program in $programs; do
            case $program\ $1 in liggghts*sizes | liggghts*threads) continue ;; esac
            value=$(measure_$program "$1" "$2" "$3" $steps)
            echo "$program $value"
        done
    done >values
    row "$1" "$2" "$3" $steps
}

provenance
echo "# repose, lammps, liggghts: 1e6 particle-steps per second of processor time, medians; for a sample seconds of the process"
echo "# threads: all $processors processors, per second of wall time"
echo "# ratio: rate of repose over that of the peer, median of the rounds, with the smallest (min) and the largest (max)"
programs=ours
if ! command -v lmp >/dev/null; then echo "# lammps: not installed"; else
    echo "# lammps: $(lmp -h | sed -n 's/.*Simulator - \(.*\)/\1/p')"
    programs="lammps $programs"
fi
if ! command -v liggghts >/dev/null; then echo "# liggghts: not installed"; else
    echo "# liggghts: $(liggghts -h | sed -n 's/.*Version LIGGGHTS-PUBLIC \([^,]*\),.*/\1/p')"
    programs="$programs liggghts"
fi
printf '# units: \t\t\t\t\t1e6/s\t1e6/s\t\t\t\t1e6/s\t\t\t\n'
printf 'scene\tstate\tgrains\tsteps\trounds\trepose\tlammps\tlammps_ratio\tlammps_min\tlammps_max'
printf '\tliggghts\tliggghts_ratio\tliggghts_min\tliggghts_max\n'
echo "$cases" | grep -E "$pattern" | while read -r scene state n; do
    if [ -n "$scene" ]; then compare "$scene" "$state" "$n" </dev/null; fi
done
