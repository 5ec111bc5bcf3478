#!/bin/sh
# What a change costs: each patch of this folder is a small change of one kind, as its first line says. It applies, builds, and
# passes lint and the suites of its second line. With any of its files left out, the build, lint or one of these suites fails:
# nobody can forget that file.
#
#   sh tests/changes/changes.sh BUILD [NAME...]    prints a row a change, and fails where one does not hold; BUILD is made
#   sh tests/changes/changes.sh --table            the files and lines of each, as CONTRIBUTING.md has them
set -u
here=tests/changes
head_of() { sed -n "s/^$2: //p;/^diff /q" "$here/$1.patch"; }
files_of() { sed -n 's,^diff --git a/.* b/,,p' "$here/$1.patch"; }
lines_of() { sed -n 's/^+[^+]/&/p' "$here/$1.patch" | wc -l; }
names() { for patch in "$here"/*.patch; do basename "$patch" .patch; done; }
list() { printf '%s' "$1" | sed "s/.*/\`&\`/" | tr '\n' ' ' | sed 's/ /, /g'; }

if [ "$1" = --table ]; then
    echo '| change | files | and for tests | lines |'
    echo '|---|---|---|---|'
    for name in $(names); do
        echo "| $(head_of "$name" change): \`$name\` | $(list "$(files_of "$name" | grep -v '^tests/')") |" \
            "$(list "$(files_of "$name" | grep '^tests/')") | $(lines_of "$name") |" | sed 's/  */ /g'
    done
    exit
fi

quick='-std=c11 -O1 -ffp-contract=off -fno-math-errno -pthread -fPIE -Werror=switch-enum -Werror=implicit-function-declaration'
build=$1
shift
bad=0
work=$build/changes
rm -rf "$work"
mkdir -p "$work/base/build"
find . -mindepth 1 -maxdepth 1 ! -name .git ! -path "./${build%%/*}" -exec cp -a {} "$work/base" \;
for made in obj commit figures.mk mutants.list repose report check core; do cp -a "$build/$made" "$work/base/build"; done
cp -a "$build"/lib*.a "$work/base/build"
rm -r "$work/base/$here"

# apply NAME TREE [--exclude=FILE]: in no repository, whose folders git would take for those of the patch.
apply() {
    patch=$PWD/$here/$1.patch tree=$2
    shift 2
    (cd "$tree" && GIT_CEILING_DIRECTORIES=$(dirname "$PWD") git apply "$@" "$patch")
}

# What sees that something is wrong with a tree: the build, lint, a suite, or nothing. Whether the code is formatted and all
# else that lint looks at is asked of the whole change alone.
seen_in() {
    tree=$1 lint=$2
    shift 2
    make -s -C "$tree" -j"$(nproc)" build/check build/repose build/report CFLAGS="$quick" >"$tree/build.log" 2>&1 || { echo build && return; }
    (cd "$tree" && $lint >lint.log 2>&1) || { echo lint && return; }
    for suite; do
        (cd "$tree" && REPOSE=build/repose build/check -j"$(nproc)" --stop "$suite" >"$suite.log" 2>&1) || { echo "$suite" && return; }
    done
    echo nothing
}

for name in ${*:-$(names)}; do
    suites=$(head_of "$name" suites)
    from=$(date +%s)
    rm -rf "$work/whole" "$work/less"
    cp -a "$work/base" "$work/whole"
    apply "$name" "$work/whole" || { bad=1 && continue; }
    seen=$(seen_in "$work/whole" "make -s lint" $suites)
    [ "$seen" = nothing ] || bad=1
    printf '%s\t%s\n' "$name" "$([ "$seen" = nothing ] && echo passes || echo "FAILS: $seen")"
    [ "$(files_of "$name" | wc -l)" -gt 1 ] || continue
    for file in $(files_of "$name"); do
        rm -rf "$work/less"
        case $file in # made of the tree in which fewer objects are stale
        *.h)
            cp -a "$work/base" "$work/less"
            apply "$name" "$work/less" --exclude="$file" ;;
        *)
            cp -a "$work/whole" "$work/less"
            rm "$work/less/build/"lib*.a # of files that may be gone
            apply "$name" "$work/less" -R --include="$file" ;;
        esac
        seen=$(seen_in "$work/less" "python3 -B tests/rooms.py build" $suites)
        [ "$seen" != nothing ] || { bad=1 && seen="NOTHING SEES IT"; }
        printf '%s\twithout %s\t%s\n' "$name" "$file" "$seen"
    done
    printf '%s\ttook %d s\n' "$name" "$(($(date +%s) - from))"
done
exit $bad
