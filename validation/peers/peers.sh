#!/bin/bash
# Repose against LAMMPS on the same scene, from the same start: a table on standard output.
# usage: peers.sh REPOSE WORK SETTLED FLOWING PAIRS   the sizes as lists in one word: "400 1600"
#
# Each ratio is the median of paired runs, ours and theirs in turn, of processor time on one core, so that a busy
# machine slows both. At rest and flowing the time is that of the timed steps alone, 2000 steps after the start;
# of a sample that of the whole process. Particle-steps are summed over the grains present at each step (in LAMMPS
# every 50th). A peer that is not installed gets a note instead of rows.
set -eu -o pipefail
export LC_ALL=C OMP_NUM_THREADS=1
repose=$(realpath "$1") work=$2 settled=$3 flowing=$4 pairs=$5
here=$(realpath "$(dirname "$0")")
[ "$(id -u)" != 0 ] || export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
pin=
if command -v taskset >/dev/null; then pin="taskset -c $(($(nproc) - 1))"; fi
mkdir -p "$work"
cd "$work"

. "$here/start.sh"

# LAMMPS' data file of a table of grains, all digits.
data() { # N
    columns x y r <"$1" | awk -v n="$2" '{ line[NR] = sprintf("%d 1 %.17g 1.0 %s %s 0", NR, 2 * $3, $1, $2) }
        END { W = 0.2 * sqrt(n)
              printf "grains\n\n%d atoms\n1 atom types\n0 %.17g xlo xhi\n0 %.17g ylo yhi\n-0.2 0.2 zlo zhi\n\nAtoms # sphere\n\n", NR, W, 2 * W + 1
              for (i = 1; i <= NR; i++) print line[i] }'
}

# million particle-steps a second of processor time
ours() { # state N steps
    $pin "$repose" bench --start "settled_$2.tsv" --state "$1" --floor absorbs --steps "$3" --repeat 1 |
        columns median
}
lammps() {
    $pin lmp -in "$here/box.in" -log none -v data "settled_$2.data" -v state "$1" -v warm 2000 -v steps "$3" >lmp.log
    awk '/^timed/ { on = 1 }
         on && NF == 2 && $1 ~ /^[0-9]+$/ && $2 ~ /^[0-9]+$/ { if (seen++) sum += ($1 - step) * ($2 + atoms) / 2; step = $1; atoms = $2 }
         on && /^Loop time/ { loop = $4 }
         on && /CPU use/ { print sum / (loop * $1 / 100) / 1e6; exit }' lmp.log
}

# seconds of processor time of a whole process
seconds() { (TIMEFORMAT='%U %S'; { time "$@" >process.log; } 2>&1) | tail -1 | awk '{ print $1 + $2 }'; }
ours_sample() {
    seconds $pin "$repose" bench --start dilute_400.tsv --state sample --floor absorbs --repeat 1 -o final.tsv
}
lammps_sample() {
    seconds $pin lmp -in "$here/box.in" -log none -v data dilute_400.data -v state sample -v final final.dump
}

# A row of the pairs "ours theirs ratio" on standard input.
row() { # state N steps
    sort -g -k3 | awk -v head="$1\t$2\t$3" '{ ours[NR] = $1; theirs[NR] = $2; ratio[NR] = $3 }
        END { print head, NR, median(ours), median(theirs), ratio[int((NR + 1) / 2)], ratio[1], ratio[NR] }
        function median(a,   i, j, t) {
            for (i = 2; i <= NR; i++) for (j = i; j > 1 && a[j] < a[j - 1]; j--) { t = a[j]; a[j] = a[j - 1]; a[j - 1] = t }
            return a[int((NR + 1) / 2)] }' OFS='\t'
}

compare() { # state N
    local steps=$((20000000 / $2)) k a b
    if [ "$1" = flowing ] && [ $steps -gt 10000 ]; then steps=10000; fi
    for k in $(seq "$pairs"); do
        a=$(ours "$1" "$2" $steps) b=$(lammps "$1" "$2" $steps)
        echo "$a $b" | awk '{ print $1, $2, $1 / $2 }'
    done | row "$1" "$2" $steps
}

compare_samples() {
    local k a b
    for k in $(seq "$pairs"); do
        a=$(ours_sample) b=$(lammps_sample)
        echo "$a $b" | awk '{ print $1, $2, $2 / $1 }'
    done | row sample 400 80000
}

provenance
echo "# repose, lammps: 1e6 particle-steps a second of processor time, medians; of a sample seconds of the process"
echo "# ratio: by how much repose is faster, median of the pairs, with the least and the largest"
if ! command -v lmp >/dev/null; then echo "# lammps: not installed"; else
    echo "# lammps: $(lmp -h | sed -n 's/.*Simulator - \(.*\)/\1/p' | head -1)"
fi
echo "# liggghts: not compared, there is no script for it"
printf '# units: \t\t\t\t1e6/s\t1e6/s\t\t\t\n'
printf '# state\tgrains\tsteps\tpairs\trepose\tlammps\tratio\tratio_min\tratio_max\n'
command -v lmp >/dev/null || exit 0
for n in $(printf '%s\n' $settled $flowing | sort -un); do
    settle "$n"
    data "settled_$n.tsv" "$n" >"settled_$n.data"
done
for n in $settled; do compare settled "$n"; done
for n in $flowing; do compare flowing "$n"; done
dilute 400
data dilute_400.tsv 400 >dilute_400.data
compare_samples
