#!/bin/bash
# How cost and memory grow with the number of grains, and what two workers give: tables growth and workers.
# usage: growth.sh REPOSE WORK growth "1000 10000 ..." | growth.sh REPOSE WORK workers PAIRS
set -eu -o pipefail
export LC_ALL=C
repose=$(realpath "$1") work=$2 table=$3 argument=$4 here=$(realpath "$(dirname "$0")")
mkdir -p "$work"
cd "$work"
. "$here/start.sh"

# 1e6 grains as 10 x 10 boxes of 10 000 at rest, beside and on one another, rather than an hour of settling.
tiled() {
    settle 10000
    { printf '# x\ty\tr\n'
      columns x y r <settled_10000.tsv | awk '{ x[NR] = $1; y[NR] = $2; r[NR] = $3; if ($2 + $3 > top) top = $2 + $3 }
          END { for (j = 0; j < 10; j++) for (i = 0; i < 10; i++) for (k = 1; k <= NR; k++)
                    printf "%.17g\t%.17g\t%s\n", x[k] + 20 * i, y[k] + top * j, r[k] }'; } >settled_1000000.tsv
}

growth() { # sizes
    local n
    provenance
    echo "# rates: 1e6 particle-steps a second of processor time, medians of three; bytes: held by a grain"
    for n in $1; do
        if [ "$n" = 1000000 ]; then tiled; else settle "$n"; fi
        for state in settled flowing; do "$repose" bench --start "settled_$n.tsv" --state $state --repeat 3; done |
            columns grains median contacts pairs bytes | awk 'NR == 1 { row = $0 } END { print row, $2 }' OFS='\t' | tr ' ' '\t'
    done | awk -F'\t' '{ line[NR] = $0; x = log($1); y = log($1 / $2); sx += x; sy += y; xx += x * x; xy += x * y }
        END { if (NR > 1) printf "# exponent: %.3f (of the time of a step at rest)\n", (xy - sx * sy / NR) / (xx - sx * sx / NR)
              print "# units: \t1e6/s\t1/grain\t1/grain\tB/grain\t1e6/s"
              print "# grains\tsettled\tcontacts\tpairs\tbytes\tflowing"
              for (i = 1; i <= NR; i++) print line[i] }'
}

wall_time() { # workers
    rm -rf sweep
    "$repose" sweep plan sweep.cfg -o sweep >/dev/null
    (TIMEFORMAT=%R; { time "$repose" sweep run sweep -j "$1" >/dev/null 2>&1; } 2>&1)
}

workers() { # pairs
    cat >sweep.cfg <<'S'
protocol = "repose"; replicas = 16; seed = 1993;
fixed = { W = 4.0; H = 4.0; stop = "steps"; fill_steps = 30000; relax_steps = 50000; };
S
    provenance
    echo "# efficiency: time of one worker over twice that of two, by the clock on the wall: needs an idle machine"
    printf '# units: s\ts\t\n# one\ttwo\tefficiency\n'
    local k
    for k in $(seq "$1"); do
        echo "$(wall_time 1) $(wall_time 2)" | awk '{ print $1, $2, $1 / (2 * $2) }' OFS='\t'
    done
}

$table "$argument"
