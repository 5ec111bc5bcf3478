#!/bin/sh
# Do the tests see a changed sign, factor, index or comparison? Each mutant that mutants.c lists is compiled in a
# copy of the tree, and the suites nearest to its file run until one fails; running for ever is a failure too.
#
#   sh tests/mutate/mutate.sh BUILD NUMBER JOBS SEED    from the top of the tree; writes
#                                                       BUILD/tables/mutate/mutants.tsv, a row a mutant, and
#                                                       summary.tsv, a row a file, which
#                                                       results keeps
#
# Some mutants change no result: validation/mutants.txt has them, and why. Status 1: of the others the tests see
# less than 95 %. Status 2: a line of that file is no mutant, or the tests fail without one.
set -eu
export LC_ALL=C
unset MAKEFLAGS # of the make that runs this: the copies build their own
limit_cpu=100   # seconds, three times what the suites of a file may take
limit_wall=600  # on a machine that does other things too
at_once=1       # tests of a suite
times=/dev/null # of the suites
# what swaps arguments of other types does not compile
flags='-O1 -Werror=format -Werror=int-conversion -Werror=incompatible-pointer-types -Werror=discarded-qualifiers'
tab='	'

files='analytic/*.c src/angle/*.c src/sparse/sparse.c src/core/elementary.c src/statics/*.c src/stats/*.c src/stress/*.c
    src/dem/law/law.inl src/dem/law/laws.c src/dem/law/bodies.c src/dem/loops/loops.inl src/dem/loops/width_1.c src/dem/state/motion.inl
    src/dem/methods/ahead.c src/dem/methods/verlet.c src/dem/papers/gear.c
    src/dem/papers/implicit.c src/dem/methods/gravity.c src/dem/papers/hard.c src/dem/methods/step.c src/dem/state/slots.c src/dem/state/vec.c
    src/dem/forces/*.c src/dem/list/removal.c src/dem/observe/*.c src/dem/setup/*.c src/dem/sim.c src/dem/run.c src/dem/change.c
    sweeps/*/*.c src/table/*.c src/params/*.c src/dem/scene/*.c src/experiment/*.c src/experiment/modules/*.c
    report/*.c src/cli/*.c src/cli/commands/*.c src/cli/derive/*.c
    src/export/*.c src/view/*.c
    figures/lh/*.gp figures/li/*.gp
    validation/cases.c validation/oblique.c validation/solved_pile.c'

suites_of() {
    case $1 in src/* | sweeps/*) echo scene experiment actions golden ;; esac # what all of it ends in
    case $1 in
    analytic/*) echo property analytic ;;
    src/angle/*) echo property angle view tables cli ;;
    src/stats/ensemble.c | src/stats/series.c) echo trend angle notes flux ;;
    report/verdict.c) echo claims ;;
    src/stats/lines.c | src/stats/trend.c) echo trend evidence calibrate_text tables angle ;;
    src/stats/identify.c | src/stats/least.c) echo identify calibrate_text ;;
    src/experiment/modules/base.c) echo piles experiment columns ;;
    src/experiment/*) echo expression experiment actions columns repose flux drop stress sweep run ;;
    src/core/elementary.c) echo core expression golden ;;
    src/dem/change.c) echo actions experiment ;;
    src/params/expression.c | src/params/lets.c) echo expression experiment ;;
    figures/*) echo figures ;;
    validation/*) echo helpers contacts rotation property ;;
    src/sparse/sparse.c) echo sparse property piles equilibrium midpoint implicit ;;
    src/statics/*) echo property piles equilibrium ;;
    src/dem/scene/fill.c | src/dem/scene/radii.c) echo fills scene golden experiment ;;
    src/dem/scene/output.c) echo core tables scene keys evidence sweep cli dem ;;
    src/dem/scene/*) echo walls scene material fills tables keys notes cli ;;
    src/dem/setup/physics.c | src/dem/setup/check.c) echo scene dem laws walls keys units hard motion soft tables sweep ;;
    src/core/folder.c) echo run cli folders power ;;
    src/core/* | src/params/* | src/table/table.c) echo core tables scene keys evidence sweep cli ;;
    src/table/columns.c | src/table/where.c) echo core columns calibrate_text tables evidence options cli ;;
    src/cli/commands/export.c | src/export/*) echo export view help options ;;
    report/pages.c) echo help evidence claims cli ;;
    src/cli/commands/view.c | src/view/*) echo view help options ;;
    src/cli/commands/help.c) echo help install ;;
    src/cli/commands/params.c) echo help options experiment ;;
    src/cli/closing.c | src/cli/progress.c) echo view run ;;
    src/cli/options.c | src/cli/command.c) echo help notes evidence options tables columns claims cli ;;
    src/cli/commands/sweep.c) echo cli folders sweep notes tables ;;
    src/cli/commands/calibrate.c | sweeps/engine/calibrate.c) echo calibrate_text options ;;
    src/cli/commands/run.c) echo view tables options run cli folders ;;
    src/cli/commands/pile.c) echo notes equilibrium tables options cli ;;
    report/*) echo evidence claims options cli ;;
    src/cli/*) echo notes evidence options tables columns claims cli ;;
    sweeps/protocols/pile_tables.c) echo tables notes piles cli ;;
    src/stress/dip.c) echo stress piles drop evidence ;;
    src/stress/*) echo stress drop piles columns ;;
    src/dem/papers/implicit.c) echo midpoint implicit dem units ledger ;;
    src/dem/methods/ahead.c | src/dem/methods/verlet.c) echo units dem removal threads motion rotation soft hard laws walls golden ;;
    src/dem/observe/ledger.c) echo units ledger walls ;;
    src/dem/observe/observe.c | src/dem/forces/contact.c) echo units soft rotation motion stress scene golden dem ;;
    src/dem/list/removal.c) echo removal dem units ;;
    src/dem/setup/* | src/dem/methods/gravity.c | src/dem/state/vec.c | src/dem/methods/step.c | src/dem/sim.c | src/dem/run.c)
        echo units scene walls golden motion hard soft rotation dem laws ;;
    sweeps/engine/experiment.c) echo experiment sweep run cli ;;
    src/run/*) echo run experiment tables cli ;;
    sweeps/protocols/protocols.c) echo sweep golden tables notes cli ;;
    sweeps/engine/pool.c | sweeps/engine/sweep.c) echo sweep drill notes tables evidence cli run ;;
    sweeps/protocols/outline.c) echo golden piles equilibrium ;;
    sweeps/protocols/pile.c) echo piles golden ;;
    sweeps/engine/*) echo sweep notes tables evidence cli drill ;;
    src/dem/forces/walls.c | src/dem/forces/touch.c | src/dem/state/slots.c) echo units actions walls scene tables contacts incline rotation golden ledger ;;
    *) echo units soft property material sizes impact implicit rotation incline contacts published motion hard walls golden scene dem laws ;;
    esac
}

# Those suites, the quickest first; the times are in the folder $2.
quickest() { for suite in $(suites_of "$1" | tr ' ' '\n' | sort -u); do grep -w "$suite" "$2/times"; done | sort -n | cut -d ' ' -f 2; }

# Build and test the tree $1, beside that of the program as it is; prints the outcome and the test that saw it,
# "broken" if the tree does not compile.
try() {
    (
        cd "$1"
        make -s build/check build/repose build/report WERROR="$flags" >build.log 2>&1 || { echo "broken$tab-"; exit; }
        ulimit -c 0
        ulimit -t $limit_cpu
        shift
        for suite in "$@"; do
            from=$(date +%s%N)
            REPOSE=build/repose timeout $limit_wall build/check --stop -j $at_once "$suite" >check.log 2>&1 &&
                echo "$(($(date +%s%N) - from)) $suite" >>"$times" && continue
            echo "killed$tab$(sed -n -e 's/, [0-9.]* s$//' -e 's/^  FAILED  //p' check.log | grep -m 1 . || echo time)"
            exit
        done
        echo "survived$tab-"
    )
}

# One mutant: line $2 of the list in the folder $1.
if [ "${3-}" = one ]; then
    work=$1 tree=$1/tree_$2 result=$1/result_$2
    [ ! -f "$result" ] || exit 0
    sed -n "$2p" "$work/list" >"$result.mutant"
    IFS=$tab read -r file line rest <"$result.mutant"
    rm -rf "$tree"
    cp -a "$work/tree" "$tree"
    { head -n $((line - 1)) "$file" && cut -f 5 "$result.mutant" && tail -n +$((line + 1)) "$file"; } >"$tree/$file"
    begin=$(date +%s)
    outcome=$(try "$tree" $(quickest "$file" "$work"))
    echo "$outcome$tab$(($(date +%s) - begin))" >"$result.new"
    mv "$result.new" "$result"
    rm -rf "$tree" "$result.mutant"
    if [ -t 2 ]; then printf '\r%d mutants ' "$(ls "$work" | grep -c '^result_[0-9]*$')" >&2; fi
    exit
fi

build=$1 number=$2 jobs=$3 seed=$4
work=$build/mutate
mkdir -p "$build/tables/mutate"
${CC:-gcc} -std=c11 -O2 -D_GNU_SOURCE -I. -Isrc tests/mutate/mutants.c -o "$build/mutants"
"$build/mutants" validation/mutants.txt "$seed" $files >"$build/mutants.list"
[ "$number" -gt 0 ] || exit 0 # a look at the exceptions alone

# a run of the same code that was stopped goes on, and another seed needs no second look at the code as it is
sum=$(cat Makefile $(find analytic figures report src sweeps tests validation -type f ! -name mutants.txt | sort) | cksum)
if [ "$sum" != "$(cat "$work/sum" 2>/dev/null)" ]; then
    rm -rf "$work"
    mkdir -p "$work/tree"
    find . -mindepth 1 -maxdepth 1 ! -name .git ! -path "./${build%%/*}" -exec cp -a {} "$work/tree" \;
    make -s -C "$work/tree" -j "$jobs" build/check build/repose build/report WERROR="$flags" >/dev/null 2>&1
    outcome=$(limit_wall=6000 at_once=$jobs times=$PWD/$work/times
        try "$work/tree" $(for file in $files; do suites_of "$file"; done | tr ' ' '\n' | sort -u))
    [ "$outcome" = "survived$tab-" ] || { echo "mutate: without a mutant: $outcome" >&2; exit 2; }
    echo "$sum" >"$work/sum"
fi
mv "$build/mutants.list" "$work/list"
echo "$seed" | cmp -s - "$work/seed" || rm -f "$work"/result_*
echo "$seed" >"$work/seed"

# what does not compile is no mutant: another takes its place
most=$(wc -l <"$work/list") from=1 to=$number
while [ "$from" -le "$to" ] && [ "$from" -le "$most" ]; do
    [ "$to" -le "$most" ] || to=$most
    seq "$from" "$to" | xargs -P "$jobs" -I N sh tests/mutate/mutate.sh "$work" N one
    from=$((to + 1)) to=$((number + $(seq "$to" | sed "s|^|$work/result_|" | xargs cat | grep -c ^broken || true)))
done
if [ -t 2 ]; then printf '\r\033[K' >&2; fi

# Of one that survives, the outcome is what the list has: survived or equivalent.
header="# commit: $(git describe --always --dirty 2>/dev/null || echo unknown)
# command: make mutate MUTANTS=$number SEED=$seed"
rows=$build/tables/mutate/mutants.tsv
{
    echo "$header"
    printf '# units: -\t-\t-\t-\t-\t-\t-\ts\nfile\tline\tkind\toriginal\tmutant\toutcome\tby\twall_time\n'
    seq $((from - 1)) | sed "s|^|$work/result_|" | xargs cat | paste "$work/list" - | head -n $((from - 1)) |
        sed -e '/\tbroken\t-\t[0-9]*$/d' -e 's/\t[a-z]*\tkilled\t\([^\t]*\t[0-9]*\)$/\tkilled\t\1/' \
            -e 's/\tsurvived\t-\(\t[0-9]*\)$/\t-\1/'
} >"$rows"

number_of() { grep -v '^#' "$rows" | cut -f 1,6 | grep -c "^$1$tab$2\$" || true; }
percent() { awk "BEGIN { print $2 ? 100 * $1 / $2 : 100 }"; }
summary() {
    killed=$(number_of "$1" killed) equivalent=$(number_of "$1" equivalent) survived=$(number_of "$1" survived)
    seen=$(percent "$killed" $((killed + survived))) seen_of_all=$(percent "$killed" $((killed + equivalent + survived)))
}
{
    echo "$header"
    printf '# units: -\t1\t1\t1\t1\t%%\t%%\nfile\tmutants\tkilled\tequivalent\tsurvived\tkilled_percent\tkilled_of_all_percent\n'
    for file in $(grep -v '^#' "$rows" | sed 1d | cut -f 1 | sort -u) all; do
        summary "$(echo "$file" | sed 's/^all$/.*/')"
        printf '%s\t%d\t%d\t%d\t%d\t%s\t%s\n' "$file" $((killed + equivalent + survived)) "$killed" "$equivalent" \
            "$survived" "$seen" "$seen_of_all"
    done
} >"$build/tables/mutate/summary.tsv"
cp "$build/tables/mutate/summary.tsv" results/mutate # the report takes it from there
sh report/keep.sh

sed -n "s/^\([^$tab]*\)$tab\([0-9]*\)$tab[^$tab]*$tab[^$tab]*$tab\([^$tab]*\)${tab}survived$tab.*/survived: \1:\2: \3/p" "$rows"
summary '.*'
echo "mutate: $killed of $((killed + equivalent + survived)) killed, $seen_of_all %; $equivalent change no result: $seen % of the others"
[ $((100 * killed)) -ge $((95 * (killed + survived))) ]
