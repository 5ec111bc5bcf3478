#!/bin/bash
# Cost and memory against the number of grains, and efficiency of two workers: tables scaling and workers.
# usage: scaling.sh REPOSE WORK scaling "1000 10000 ..." | scaling.sh REPOSE WORK workers PAIRS
set -eu -o pipefail
export LC_ALL=C
repose=$(realpath "$1") work=$2 table=$3 argument=$4 here=$(realpath "$(dirname "$0")")
mkdir -p "$work"
cd "$work"
. "$here/start.sh"

scaling() { # sizes
    local n start
    provenance
    echo "# rates: 1e6 particle-steps per second of processor time, medians of three; bytes: held per grain"
    for n in $1; do
        settle box "$n"
        for state in settled flowing; do "$repose" bench --start "$start" --width "$(width "$n")" --state $state --repeat 3; done |
            columns grains median contacts pairs bytes | awk 'NR == 1 { row = $0 } END { print row, $2 }' OFS='\t' | tr ' ' '\t'
    done >scaling.rows
    if [ "$(wc -l <scaling.rows)" -gt 1 ]; then
        awk '{ print $1, $1 / $2 }' scaling.rows | "$repose" stats fit - --x 1 --y 2 --scale log | columns slope |
            xargs printf '# exponent: %.3f (of the time of a step at rest)\n'
    fi
    printf '# units: \t1e6/s\t1/grain\t1/grain\tB/grain\t1e6/s\n'
    printf 'grains\tsettled\tcontacts\tpairs\tbytes\tflowing\n'
    cat scaling.rows
}

seconds() { # workers: wall time, and processor time of both
    rm -rf sweep
    "$repose" sweep plan sweep.cfg -o sweep >/dev/null
    (TIMEFORMAT='%R %U %S'; { time "$repose" sweep run sweep -j "$1" >/dev/null 2>&1; } 2>&1)
}

workers() { # pairs
    cat >sweep.cfg <<'S'
protocol = "repose"; replicas = 64; seed = 1993;
fixed = { W = 4.0; H = 4.0; stop = "steps"; fill_steps = 30000; relax_steps = 50000; };
S
    provenance
    echo "# efficiency: wall time of one worker over twice that of two: needs an idle machine"
    echo "# busy: processor time of two workers over twice the wall time"
    local k
    for k in $(seq "$1"); do
        echo "$(seconds 1) $(seconds 2)" | awk '{ print $1, $4, $1 / (2 * $4), ($5 + $6) / (2 * $4) }' OFS='\t'
    done >workers.rows
    echo "$(cut -f 1 workers.rows | sort -g | head -1) $(cut -f 2 workers.rows | sort -g | head -1)" |
        awk '{ printf "# shortest: %.3g s by one, %.3g s by two, efficiency %.3f\n", $1, $2, $1 / (2 * $2) }'
    printf '# units: s\ts\t\t\n'
    printf 'one\ttwo\tefficiency\tbusy\n'
    cat workers.rows
}

$table "$argument"
