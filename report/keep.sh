#!/bin/sh
# Pages hold tables of `make figures` and `make validate` too: results/kept has the small ones that they need, so that
# `make check` makes each page again. Usage: keep.sh TABLES, at the top; those there that differ by more than their
# making and their times replace the kept ones. Without TABLES, and at the end: results/checksums.txt has each table of
# results a second time, so that a number changed by hand is found.
set -eu
numbers() {
    awk -F'\t' '/^# (program|compiler|libraries|command|runs made by|run_time|commit):/ { next } /^#/ { print; next }
        !n { n = NF; for (k = 1; k <= n; k++) time[k] = $k ~ /^(seconds|run_time)$/ }
        { for (k in time) if (time[k]) $k = ""; print }' "$1"
}
cd results
for table in ${1+kept/*/*.tsv}; do
    case $table in kept/precision/*) continue ;; esac # run times: replaced by hand
    new=../$1/${table#kept/}
    [ "$(numbers "$new")" = "$(numbers "$table")" ] || cp "$new" "$table"
done
find . -name '*.tsv' | sed 's|^\./||' | LC_ALL=C sort | xargs sha256sum >checksums.txt
