#!/bin/bash
# Cost and memory against the number of grains, and efficiency of two workers: tables growth and workers.
# usage: growth.sh REPOSE WORK growth "1000 10000 ..." | growth.sh REPOSE WORK workers PAIRS
set -eu -o pipefail
export LC_ALL=C
repose=$(realpath "$1") work=$2 table=$3 argument=$4 here=$(realpath "$(dirname "$0")")
mkdir -p "$work"
cd "$work"
. "$here/start.sh"

# 1e6 grains: ten boxes of 100 000 at rest side by side, every other one a mirror image, so that the grains that
# touched a wall touch their own images. A square box of a million grains would take hours to settle.
joined() {
    settle 100000
    { printf '# x\ty\tr\n'
      columns x y r <settled_100000.tsv | awk '{ x[NR] = $1; y[NR] = $2; r[NR] = $3 }
          END { W = 0.2 * sqrt(NR)
                for (i = 0; i < 10; i++) for (k = 1; k <= NR; k++)
                    printf "%.17g\t%s\t%s\n", (i % 2 ? W * (i + 1) - x[k] : W * i + x[k]), y[k], r[k] }'; } >joined_1000000.tsv
}

growth() { # sizes
    local n start width
    provenance
    echo "# rates: 1e6 particle-steps per second of processor time, medians of three; bytes: held per grain"
    for n in $1; do
        start=settled_$n.tsv width=auto
        if [ "$n" = 1000000 ]; then joined; start=joined_$n.tsv width=632.4555320336759; else settle "$n"; fi
        for state in settled flowing; do "$repose" bench --start "$start" --width $width --state $state --repeat 3; done |
            columns grains median contacts pairs bytes | awk 'NR == 1 { row = $0 } END { print row, $2 }' OFS='\t' | tr ' ' '\t'
    done | awk -F'\t' '{ line[NR] = $0; x = log($1); y = log($1 / $2); sx += x; sy += y; xx += x * x; xy += x * y }
        END { if (NR > 1) printf "# exponent: %.3f (of the time of a step at rest)\n", (xy - sx * sy / NR) / (xx - sx * sx / NR)
              print "# units: \t1e6/s\t1/grain\t1/grain\tB/grain\t1e6/s"
              print "# grains\tsettled\tcontacts\tpairs\tbytes\tflowing"
              for (i = 1; i <= NR; i++) print line[i] }'
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
    done | awk -F'\t' '{ line[NR] = $0; if (NR == 1 || $1 < one) one = $1; if (NR == 1 || $2 < two) two = $2 }
        END { printf "# shortest: %.3g s by one, %.3g s by two, efficiency %.3f\n", one, two, one / (2 * two)
              print "# units: s\ts\t\t"
              print "# one\ttwo\tefficiency\tbusy"
              for (i = 1; i <= NR; i++) print line[i] }'
}

$table "$argument"
