#!/bin/sh
# What static analysis and valgrind say of the program, against tests/analyze.txt, which lists each finding that is no fault and why.
# Arguments: the build folder, the number of processes, and "readers" for gcc -fanalyzer alone, of the files that read the bytes of
# strangers: 25 s of processor time, where all files take four minutes. Else tools that are missing are installed.
# A finding is a line "tool file id"; a new one, and a line of the list that no tool finds any longer, is status 1.
build=$1 jobs=$2 part=$3
export LC_ALL=C
[ "$part" ] || sh tests/setup.sh clang clang-tidy clang-tools cppcheck valgrind || exit 1
mkdir -p "$build/analyze"
found=$build/analyze/found
: >"$found.raw"
flags="-include tests/analyze.h -D_GNU_SOURCE -Isrc -I. -std=c11 -w $(pkg-config --cflags gsl libconfig sqlite3 libxxhash jansson)"
files=$(ls src/*/*.c src/*/*/*.c analytic/*.c report/*.c sweeps/*/*.c | grep -v core/status.c)
# the list is of what this compiler finds; others find more and less
[ -z "$part" ] || [ "$(gcc -dumpversion)" = 12 ] || { echo "analyze: left out: gcc $(gcc -dumpversion), not 12"; exit; }
[ -z "$part" ] || files=$(printf '%s\n' $files | grep -E '^(src/(core/(file|folder|snapshot)|params/|table/|dem/(snapshot|scene/(read|set))|view/read)|sweeps/engine/(store|plan|experiment))')
checks='-*,bugprone-*,-bugprone-easily-swappable-parameters'
checks="$checks,-bugprone-narrowing-conversions,-bugprone-implicit-widening-of-multiplication-result,-bugprone-macro-parentheses"
checks="$checks,-bugprone-branch-clone,-bugprone-reserved-identifier"
each() { printf '%s\n' $files | xargs -P "$jobs" -I{} sh -c "$1" 2>&1; }
# tool, then "file:line...: ... [id]" lines on standard input
keep() { sed -nE "s#^(\./|$PWD/)?([a-z][^: ]*):[0-9]+:([0-9]+:)? .*\[([^]]*)\]\$#$1 \2 \4#p" | sed 's/ -Wanalyzer/ analyzer/' >>"$found.raw"; }

echo "analyze gcc -fanalyzer"
each "gcc $(echo "$flags" | sed 's/ -w / /') -O1 -fanalyzer -fdiagnostics-plain-output -c -o /dev/null {} | cat" | grep -a 'Wanalyzer' | sed 's/ \[CWE-[0-9]*\]//' | keep gcc
conclude() {
    sort -u "$found.raw" >"$found"
    sed -n 's/^\([a-z-]* [^ ]* [^ ]*\)  *[^ ].*/\1/p' tests/analyze.txt | sort -u >"$found.known"
    comm -23 "$found" "$found.known" | sed 's/^/analyze: new: /' >"$found.new"
    [ "$part" ] || comm -13 "$found" "$found.known" | sed 's/^/analyze: found no longer, remove from tests\/analyze.txt: /' >>"$found.new"
    cat "$found.new"
    echo "analyze: $(wc -l <"$found") findings, $(wc -l <"$found.known") known to be no faults"
    [ ! -s "$found.new" ]
}
[ -z "$part" ] || { conclude; exit; }
echo "analyze cppcheck"
cppcheck -q -j "$jobs" --include=tests/analyze.h --std=c11 --enable=warning,portability -D_GNU_SOURCE -Isrc -I. --template='{file}:{line}: {message} [{id}]' \
    src analytic report sweeps 2>&1 | keep cppcheck
echo "analyze clang-tidy"
each "clang-tidy --quiet '--checks=$checks' {} -- $flags" | grep -a 'warning:' | keep clang-tidy
echo "analyze scan-build"
each "scan-build -o $build/analyze/report --use-analyzer=$(command -v clang) clang $flags -c -o /dev/null {}" | grep -a 'warning:' | keep scan-build
echo "analyze valgrind"
dir=$build/analyze/sweep
rm -rf "$dir"
printf 'protocol = "pile"; replicas = 2; fixed = { base = 5; };\n' >"$build/analyze/s.cfg"
printf 'steps = 50; fill = { N = 9; W = 1.0; H = 1.0; }; walls = ( { point = [0.0, 0.0]; direction = [0.0, 1.0]; } );\n' >"$build/analyze/scene.cfg"
printf 'fit = { mu = [0.1, 0.8]; }; measured = ( { runs = "%s/tests/fuzz/corpus/calibrate/piles"; of = "theta_r3_deg"; value = 20.0; error = 1.0; } );\n' "$PWD" >"$build/analyze/fit.cfg"
while read -r line; do
    valgrind -q --error-exitcode=99 --leak-check=full --trace-children=no "$build/repose" $line >/dev/null 2>"$build/analyze/valgrind.log" ||
        { echo "valgrind src/cli/command.c ${line%% *}" >>"$found.raw"; cat "$build/analyze/valgrind.log"; }
done <<END
lattice --base 20 --alpha-deg 30
tent --x1 0.38 --outer-deg 30 --inner-deg 45
pile --base 20 --alpha-deg 30
run $build/analyze/scene.cfg --ledger --force -o $build/analyze/run
angle slope tests/fuzz/corpus/angle_slope/pile --width 4
stress dip tests/fuzz/corpus/stress_dip/piles --profile
stats fit tests/fuzz/corpus/stats_fit/runs -x a -y b
calibrate $build/analyze/fit.cfg
sweep plan $build/analyze/s.cfg -o $dir
sweep run $dir -j 1
sweep export $dir --reduce
END

conclude
