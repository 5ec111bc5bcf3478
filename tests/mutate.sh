#!/bin/sh
# Do the tests see a changed sign, factor, index or comparison? Each mutant of tests/mutate.awk is compiled in a
# copy of the tree, and the suites nearest to its file run until one fails; running for ever is a failure too.
#
#   sh tests/mutate.sh BUILD NUMBER JOBS    from the top of the tree; writes BUILD/tables/mutate.tsv, a row a
#                                           mutant, and mutate_summary.tsv, a row a file
#
# Some mutants change no result: validation/mutants.txt has them, and why. Status 1: of the others the tests see
# less than 95 %.
set -eu
export LC_ALL=C
unset MAKEFLAGS # of the make that runs this: the copies build their own
limit_cpu=15 # seconds, three times what the suites of a file may take

suites_of() {
    case $1 in
    analytic/*) echo property analytic ;;
    src/angle/*) echo property angle ;;
    src/dem/implicit.c) echo midpoint implicit ;;
    src/dem/ledger.c) echo ledger ;;
    src/statics/equilibrium.c | src/core/stiffness.c) echo property equilibrium ;;
    src/dem/observe.c) echo soft rotation motion stress scene golden dem ;;
    src/dem/definition.c | src/dem/limits.c | src/dem/gravity.c | src/dem/step.c | src/dem/sim.c) echo golden scene motion hard soft rotation dem ;;
    sweeps/driver/protocol_pile.c) echo piles golden ;;
    sweeps/driver/protocol_repose.c) echo repose golden ;;
    *) echo soft property rotation incline statics published motion hard golden scene dem ;;
    esac
}

# Build and test the tree $1, beside that of the program as it is; prints "killed SUITE: TEST" or "survived", "broken" if it does not compile.
try() {
    (
        cd "$1"
        make -s build/check SAN='-O1 -w' >build.log 2>&1 || { echo broken; exit; }
        ulimit -c 0
        ulimit -t $limit_cpu
        shift
        if REPOSE=../tree/build/repose timeout 300 build/check --stop "$@" >check.log 2>&1; then echo survived; exit; fi
        echo "killed $(sed -n 's/^check: stopped by //p' check.log | grep . || echo crash or time)"
    )
}

# One mutant: line $2 of the list in the folder $1.
if [ "${3-}" = one ]; then
    work=$1 tree=$1/tree_$2
    [ ! -f "$work/result_$2" ] || exit 0
    sed -n "$2p" "$work/mutants" >"$work/result_$2.new"
    IFS='	' read -r file kind line rest <"$work/result_$2.new"
    rm -rf "$tree"
    cp -a "$work/tree" "$tree"
    cut -f 5- "$work/result_$2.new" | awk -v n="$line" 'NR == FNR { new = $0; next } { print FNR == n ? new : $0 }' \
        - "$work/tree/$file" >"$tree/$file"
    begin=$(date +%s)
    outcome=$(try "$tree" $(suites_of "$file"))
    printf '%s\t%d\n' "$outcome" $(($(date +%s) - begin)) >>"$work/result_$2.new"
    mv "$work/result_$2.new" "$work/result_$2"
    rm -rf "$tree"
    if [ -t 2 ]; then printf '\r%d mutants ' "$(ls "$work" | grep -c '^result_[0-9]*$')" >&2; fi
    exit
fi

build=$1 number=$2 jobs=$3
work=$build/mutate
files='analytic/*.c src/dem/law.inl src/dem/contact.inl src/dem/verlet.c src/dem/gear.c src/dem/walls.c src/dem/ground.c
    src/dem/hard.c src/dem/implicit.c src/dem/ledger.c src/statics/equilibrium.c src/core/stiffness.c
    src/dem/definition.c src/dem/limits.c src/dem/gravity.c src/dem/step.c src/dem/sim.c src/dem/observe.c
    src/angle/surface.c src/angle/criterion.c sweeps/driver/protocol_repose.c sweeps/driver/protocol_pile.c'
# a run of the same code that was stopped goes on
sum=$(cat Makefile tests/mutate.* $(find analytic src sweeps tests validation -name '*.[chi]*' | sort) | cksum)
if [ "$sum" != "$(cat "$work/sum" 2>/dev/null)" ]; then
    rm -rf "$work"
    mkdir -p "$work/tree" "$build/tables"
    cp -a Makefile analytic figures src sweeps tests validation "$work/tree"
fi

# by turns from each kind in each file
awk -f tests/mutate.awk $files | sort -t '	' -k 1,2 -k 3,3 |
    awk -F '\t' -v OFS='\t' '$1 $2 != last { turn = 0; last = $1 $2 } { print ++turn, $0 }' |
    sort -t '	' -k 1n,1 -k 4,4 | cut -f 2,3,5- >"$work/mutants"

make -s -C "$work/tree" -j "$jobs" build/check build/repose SAN='-O1 -w' >/dev/null
for file in $files; do suites_of "$file"; done | sort -u | while read -r suites; do
    [ "$(try "$work/tree" $suites)" = survived ] || { echo "mutate: $suites fails as it is" >&2; exit 2; }
done

echo "$sum" >"$work/sum"
# what does not compile is no mutant: another takes its place
from=1 to=$number
while [ "$from" -le "$to" ]; do
    seq "$from" "$to" | xargs -P "$jobs" -I N sh tests/mutate.sh "$work" N one
    from=$((to + 1)) to=$((number + $(cat "$work"/result_* | awk '/^broken\t/ { n++ } END { print n + 0 }')))
done
if [ -t 2 ]; then printf '\r\033[K' >&2; fi

header="# commit: $(git describe --always --dirty 2>/dev/null || echo unknown)"
{
    echo "$header"
    printf '# -\t-\t-\t-\t-\t-\t-\ts\n# file\tline\tkind\toriginal\tmutant\toutcome\tby\twall_time\n'
    for i in $(seq 1 "$to"); do cat "$work/result_$i"; done | awk -F '\t' -v OFS='\t' '
        function trim(text) { gsub(/^ +| +$/, "", text); return text }
        function nth(file, line, old,   text, i, n) {
            for (i = 0; i < line && (getline text < file) > 0; i++) n += trim(text) == old
            close(file)
            return n
        }
        FILENAME == "validation/mutants.txt" { known[$1, $2, $3, $4] = !/^#/; next }
        FNR % 2 { file = $1; kind = $2; line = $3; old = trim($4); new = trim($5); next }
        $1 == "broken" { next }
        {
            outcome = by = $1
            sub(/ .*/, "", outcome)
            if (!sub(/^killed /, "", by)) by = "-"
            if (outcome == "survived" && known[file, nth(file, line, old), old, new]) outcome = "equivalent"
            print file, line, kind, old, new, outcome, by, $2
        }' validation/mutants.txt -
} >"$build/tables/mutate.tsv"
awk -F '\t' -v OFS='\t' -v header="$header" '
    !/^#/ { count[$1, $6]++; count["all", $6]++; if (!seen[$1]++) order[++n] = $1 }
    END {
        print header
        print "# -\t1\t1\t1\t1\t%\t%"
        print "# file\tmutants\tkilled\tequivalent\tsurvived\tkilled_percent\tkilled_of_all_percent"
        for (order[++n] = "all"; ++i <= n;) {
            f = order[i]; k = count[f, "killed"]; e = count[f, "equivalent"]; s = count[f, "survived"]
            print f, k + e + s, k + 0, e + 0, s + 0, k + s ? 100 * k / (k + s) : 100, 100 * k / (k + e + s)
        }
    }' "$build/tables/mutate.tsv" >"$build/tables/mutate_summary.tsv"

awk -F '\t' '$6 == "survived" { print "survived: " $1 ":" $2 ": " $5 }
    FILENAME ~ /summary/ && $1 == "all" {
        printf "mutate: %d of %d killed, %.1f %%; %d change no result: %.1f %% of the others\n", $3, $2, $7, $4, $6
        exit $6 < 95
    }' "$build/tables/mutate.tsv" "$build/tables/mutate_summary.tsv"
