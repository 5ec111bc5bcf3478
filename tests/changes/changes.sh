#!/bin/sh
# What a change costs: each patch of this folder is a small change of one kind, as its first line says. Together they apply,
# build, and pass lint and the suites of their second lines. With any file of one left out, the build, lint or one of its suites
# fails: nobody can forget that file.
#
#   sh tests/changes/changes.sh BUILD [NAME...]    prints a row for all together and for each file, and fails where one does not
#                                                  hold; BUILD is made
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
for made in obj commit sources figures.mk mutants.list repose report check core; do cp -a "$build/$made" "$work/base/build"; done
cp -a "$build"/lib*.a "$work/base/build"
rm -r "$work/base/$here"

# apply NAME TREE [--exclude=FILE]: in no repository, whose folders git would take for those of the patch.
apply() {
    patch=$PWD/$here/$1.patch tree=$2
    shift 2
    (cd "$tree" && GIT_CEILING_DIRECTORIES=$(dirname "$PWD") git apply "$@" "$patch")
}

builds() { make -s -C "$1" -j"$(nproc)" build/check build/repose build/report CFLAGS="$quick" >"$1/build.log" 2>&1; }

# The first of these suites that fails in a tree, or nothing.
failing_in() {
    tree=$1
    shift
    for suite; do
        (cd "$tree" && REPOSE=build/repose build/check -j"$(nproc)" --stop "$suite" >"$suite.log" 2>&1) || { echo "$suite" && return; }
    done
}

# What sees that a file is left out: the build; the rooms, of all that lint looks at; a suite; or nothing.
seen_in() {
    builds "$1" || { echo build && return; }
    (cd "$1" && python3 -B tests/rooms.py build >lint.log 2>&1) || { echo lint && return; }
    failing_in "$@"
}

whole=$work/whole less=$work/less
cp -a "$work/base" "$whole"
for name in ${*:-$(names)}; do apply "$name" "$whole" || exit; done
builds "$whole" || { cat "$whole/build.log" && exit 1; }
make -s -C "$whole" lint >"$whole/lint.log" 2>&1 || { cat "$whole/lint.log" && bad=1; }
failing=$(failing_in "$whole" $(for name in ${*:-$(names)}; do head_of "$name" suites; done | tr ' ' '\n' | sort -u))
[ -z "$failing" ] || { cat "$whole/$failing.log" && bad=1; }
printf 'all changes\t%s\n' "${failing:+FAILS: }${failing:-passes}"

for name in ${*:-$(names)}; do
    [ "$(files_of "$name" | wc -l)" -gt 1 ] || continue
    for file in $(files_of "$name"); do
        rm -rf "$less"
        case $file in # made of the tree in which fewer objects are stale
        *.h)
            cp -a "$work/base" "$less"
            apply "$name" "$less" --exclude="$file" ;;
        *)
            cp -a "$whole" "$less"
            rm "$less/build/"lib*.a # which may have what is gone
            apply "$name" "$less" -R --include="$file" ;;
        esac
        seen=$(seen_in "$less" $(head_of "$name" suites))
        printf '%s\twithout %s\t%s\n' "$name" "$file" "${seen:-NOTHING SEES IT}"
        [ "$seen" ] || bad=1
    done
done
exit $bad
