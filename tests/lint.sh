#!/bin/sh
# The order of the rooms, the modules' prefixes, the tables of figures, and clang-format. Arguments: the build folder,
# then module=prefix for each library, which exports its own prefix only.
build=$1
shift
bad=0
for entry; do
    module=${entry%%=*} prefix=${entry#*=}
    exported=$(nm -g --defined-only "$build/lib$module.a" | awk 'NF == 3 { print $3 }' | grep -v "^$prefix")
    if [ -n "$exported" ]; then
        echo "lint: $module exports names without its prefix $prefix:" $exported
        bad=1
    fi
done
# Libm differs between processors and C libraries in the last bit; what computes has the functions of core/elementary.
for entry; do
    module=${entry%%=*}
    case $module in view | export) continue ;; esac
    names=$(nm -A -u "$build/lib$module.a" | sed -n 's/.*:\([^:]*\.o\): *U \(hypot\|a\?sinh\?\|a\?cosh\?\|a\?tan\|atan2\|sincos\|exp2\?\|expm1\|log\|log2\|log10\|log1p\|pow\|cbrt\|fma\)$/\1 \2/p')
    [ -z "$names" ] || { echo "lint: functions of libm in $module:" $names && bad=1; }
done
# The page in a browser has these modules but folders; what they call beyond must be among the names that it does without.
for module in $(sed -n 's/^PAGE_OWN.*foreach m,\([a-z ]*\),.*/\1/p' src/page/page.mk); do nm -A -g "$build/lib$module.a"; done |
    awk '/:folder.o:/ { next } $2 == "U" { if ($3 ~ /^(rp|stats|an|dem|ang|stress|exp|cholmod)_/) used[$3] } NF == 3 && $2 != "U" { made[$3] }
        END { while ((getline name <"src/page/absent.txt") > 0) made[name]; for (name in used) if (!(name in made)) print name }' |
    grep . && echo "lint: a page lacks these: see PAGE_OWN in src/page/page.mk and src/page/absent.txt" && bad=1
# What a law has is in its row of laws.h: elsewhere none is asked for by name.
laws=$(sed -n '/^#define DEM_TANGENTIAL_LAWS/,/^$/s/^ *X(\(DEM_[A-Z_]*\),.*/\1/p; /^#define DEM_ROLLINGS/,/^$/s/^ *X(\(DEM_[A-Z_]*\),.*/\1/p' src/dem/law/laws.h)
grep -rnE "(==|!=|case) *($(echo $laws | tr ' ' '|'))\b" src sweeps analytic report --exclude-dir=law && echo "lint: a law is asked for by name" && bad=1
# What a call came to is its status: a message is for people.
grep -rnE '\b(str|mem)[a-z]*\(rp_message' src sweeps analytic report && echo "lint: a message's text decides here" && bad=1
# Names are no patterns, and no text is a command: the program has neither a shell nor patterns of names.
nm -D -u "$build/repose" | grep -wE 'system|popen|wordexp|glob|glob64|fnmatch' && echo "lint: build/repose calls these" && bad=1
python3 -B tests/rooms.py "$build" || bad=1
# The changes of `make changes` apply, and CONTRIBUTING.md has their table; a tree in which they are tried has none.
if [ -d tests/changes ]; then
    for patch in tests/changes/*.patch; do git apply --check "$patch" || { echo "lint: $patch does not apply" && bad=1; }; done
    sh tests/changes/changes.sh --table >"$build/changes.md"
    grep '^|' CONTRIBUTING.md | diff - "$build/changes.md" || { echo "lint: CONTRIBUTING.md has another table of tests/changes" && bad=1; }
fi
for figure in figures/*/*.gp; do
    named=" $(sed -n 's/^# sweeps: //p' "$figure") "
    for sweep in $(grep -v '^#' "$figure" | sed "s/published(/'claims\//g; /^load /d" | grep -oE "['\"][a-z][A-Za-z0-9_]*/" | tr -d "'\"/"); do
        ls sweeps/*/"$sweep.cfg" "validation/$sweep.c" 2>/dev/null | grep -q . || [ "$sweep" = claims ] || continue
        case $named in *" $sweep "*) ;; *) echo "lint: $figure reads a table of $sweep, which is not among its # sweeps:" && bad=1 ;; esac
    done
done
for suite in $(sed -n '/^suites_of/,/^}/s/.*) echo \([a-z_ ]*\) ;;$/\1/p; /^suites_of/,/^}/s/^ *echo \([a-z_ ]*\) ;;$/\1/p' tests/mutate/mutate.sh); do
    grep -qw "suite_$suite" tests/check.h || { echo "lint: tests/mutate/mutate.sh: no suite $suite" && bad=1; }
done
sh tests/mutate/mutate.sh "$build" 0 1 0 || { echo "lint: validation/mutants.txt has lines that are no mutants" && bad=1; }
# A build whose arithmetic has other bits is refused.
for flag in -ffast-math $([ "$(uname -m)" != x86_64 ] || echo -mfma); do
    ${CC:-gcc} "$flag" -Isrc -fsyntax-only src/core/version.c 2>&1 | grep -q 'changes the bits' || {
        echo "lint: a build with $flag is not refused" && bad=1
    }
done
# As on Arm, where the preprocessor sees nothing: the program has what is fused then, and refuses to run.
if grep -qs '\bfma\b' /proc/cpuinfo; then
    fused=$build/fused
    printf '#include "core/version.h"\nint main(void) { return rp_build_check(); }\n' >"$fused.c"
    for contract in fast off; do
        ${CC:-gcc} -O2 -mfma -U__FMA__ -ffp-contract=$contract -D_GNU_SOURCE -Isrc -o "$fused" "$fused.c" src/core/version.c src/core/status.c src/core/plain.c &&
            "$fused"
        [ $? = $([ $contract = off ] && echo 0 || echo 70) ] || { echo "lint: -ffp-contract=$contract: rp_build_check() errs" && bad=1; }
    done
fi
if ! command -v clang-format >/dev/null; then
    echo "lint: no clang-format: the format is not checked"
else
    find analytic report src sweeps tests validation examples -name '*.[ch]' -o -name '*.inl' | xargs -P "$(nproc)" -n 16 sh -c '
        for file; do clang-format --assume-filename=x.c "$file" | cmp -s - "$file" || echo "lint: clang-format -i $file"; done' sh |
        grep . && bad=1
fi
exit $bad
