#!/bin/sh
# Install Repose, as `make install` does: install.sh BUILD FOLDER VERSION MODULE... FOLDER is DESTDIR and PREFIX. No path
# is written into a file, so that the folder can be moved. All is made in a folder of its own, and copied when it is
# whole. $list names its files, and each folder that it made, with "/" at the end; "/" alone is FOLDER.
# --remove FOLDER removes these files, and these folders where they are empty.
set -e
umask 022
list=share/doc/repose/installed.txt
remove() { # remove FOLDER
    if ! [ -f "$1/$list" ]; then return; fi # nothing is there, or of a version without a list
    folders=$(LC_ALL=C grep '/$' "$1/$list" | LC_ALL=C sort -r) # a folder after what lies in it
    (cd "$1" && grep -v '/$' $list | xargs -d '\n' rm -f --)
    echo "$folders" | while read -r name; do rmdir "$1/$name" 2>/dev/null || true; done
}
if [ "$1" = --remove ]; then
    [ -f "$2/$list" ] || { echo "$2: no installation with a list of its files" >&2 && exit 1; }
    remove "$2"
    exit
fi
build=$(realpath "$1") target=$2 version=$3
to=$(mktemp -d)
trap 'rm -rf "$to"' EXIT
shift 3
put() { # put MODE FOLDER FILE...
    mode=$1 folder=$to/$2
    shift 2
    install -d "$folder" && install -m "$mode" "$@" "$folder"
}

put 755 bin "$build/repose"
put 644 share/repose/python python/*.py
put 644 share/doc/repose README.md LICENSE CITATION.cff CONTRIBUTING.md paper-repro.md
put 644 share/doc/repose/docs docs/*
put 644 share/doc/repose/figures/shown figures/shown/*.png
for folder in sweeps/*/ examples/ examples/*/; do
    case $folder in
    sweeps/engine/ | *\*/) ;;
    sweeps/*) put 644 "share/repose/$folder" "$folder"*.cfg ;;
    *) put 644 "share/repose/$folder" $(find "$folder" -maxdepth 1 -type f) ;;
    esac
done
for folder in examples sweeps python; do # links of the pages
    ln -sfn ../../repose/$folder "$to/share/doc/repose/$folder"
done
install -d "$to/share/bash-completion/completions"
"$build/repose" help --completion >"$to/share/bash-completion/completions/repose"

# Headers lie in one folder: #include <repose/dem.h>. The public ones stand between RP_C_BEGIN and RP_C_END, or hold
# macros only.
install -d "$to/include/repose" "$to/lib/pkgconfig"
for header in $(grep -l '^RP_C_BEGIN' src/*/*.h src/*/*/*.h analytic/*.h sweeps/*/*.h) src/dem/law/choices.h src/dem/law/parameters.h; do
    sed 's,^#include ".*/,#include ",' "$header" >"$to/include/repose/$(basename "$header")"
done

# One archive, of which a program links what it uses: repose-MODULE.pc names the libraries of a module, repose.pc all.
# It has a name for each of them: of equal ones pkg-config keeps the last, which may stand after what it needs.
ln -s "$build" "$to/build" # ar takes plain names alone
(
    cd "$to"
    {
        echo "create lib/librepose.a"
        for module; do echo "addlib build/lib${module%%=*}.a"; done
        printf 'save\nend\n'
    } | ar -M
    ar t lib/librepose.a >/dev/null
    rm build
)
pc() { # pc NAME DESCRIPTION PACKAGES LIBRARIES
    cat >"$to/lib/pkgconfig/$1.pc" <<EOF
libdir=\${pcfiledir}/..
includedir=\${libdir}/../include
Name: $1
Description: $2
Version: $version
Requires: $3
Libs: -L\${libdir} -l$1 $4 -lm
Cflags: -I\${includedir}
EOF
    [ "$1" = repose ] || ln -s librepose.a "$to/lib/lib$1.a"
}
pc repose "forces in and angles of granular piles" "gsl libconfig sqlite3 libxxhash jansson" -lcholmod
pc repose-analytic "lattice, continuum and tent models of piles"
pc repose-dem "discrete-element simulator of grains" "libconfig libxxhash" -lcholmod
pc repose-statics "static equilibrium of soft disks" "" -lcholmod
pc repose-angle "angles of repose, tilting and marginal stability" "gsl"
pc repose-stress "stress in piles, pressure on their base" gsl

made=$(grep '/$' "$target/$list" 2>/dev/null || true) # they may hold a person's files too
remove "$target"                                      # of another version
: >"$to/$list"
names=$(cd "$to" && find . -type d -printf '%P/\n' -o -printf '%P\n' | while read -r name; do
    case $name in
    */repose/*/ | */repose/ | *[!/]) echo "$name" ;;
    *) if ! [ -e "$target/$name" ] || echo "$made" | grep -qxF "$name"; then echo "$name"; fi ;;
    esac
done)
echo "$names" | LC_ALL=C sort >"$to/$list"
target=$(realpath -m "$target")
grep '/$' "$to/$list" | while read -r name; do mkdir -p "$target/$name"; done # those that are links stay so
cd "$to" && grep -v '/$' $list | xargs -d '\n' cp -P --parents --remove-destination -t "$target"
