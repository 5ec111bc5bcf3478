#!/bin/sh
# BUILD/report.html: the report and the pages behind it as one page, by pandoc. BUILD holds paper-repro.md, docs, figures.
# usage: page.sh REPOSE BUILD
set -eu
repose=$1 build=$2 here=$(dirname "$0") work=$2/page
command -v pandoc >/dev/null || sh "$here/../../tests/setup.sh" pandoc
rm -rf "$work"; mkdir -p "$work" # the program refuses to write over results

# The avalanche: the first pile of figure 3 with mu = 0.2, from just before its wall is removed.
every=500
"$repose" run sweeps/lh/lh3.cfg --row 80 --force -o "$work/pile" >/dev/null
opens=$(awk '$1 == "filled" { print $3 + 1 }' "$work/pile/phases.tsv")
dt=$(awk '$1 == "filled" { print $4/$3 }' "$work/pile/phases.tsv")
"$repose" run "$work/pile/scene.cfg" --every $every --force -o "$work/frames" >/dev/null
for table in states contacts; do
    awk -v last=$((opens + 60*every)) '/^#/ || $1 == "step" || $1 <= last' "$work/frames/$table.tsv" >"$work/$table.tsv" && mv "$work/$table.tsv" "$work/frames/"
done
awk -v from=$((opens - every)) -v opens="$opens" -v dt="$dt" -f "$here/frames.awk" \
    "$work/frames/states.tsv" "$work/frames/contacts.tsv" >"$work/frames.json"

# Pictures as SVG, and the pages behind the report folded below it. Links between pages become links within this one.
for png in $(sed -n 's|.*](figures/shown/\([^)]*\)\.png).*|\1|p' "$build/paper-repro.md"); do
    awk -f "$here/circles.awk" "$build/figures/shown/$png.svg" >"$work/$png.svg"
done
{
    sed 's|(figures/shown/\([^)]*\)\.png)|('"$work"'/\1.svg)|' "$build/paper-repro.md"
    for page in claims choices beyond misprints validation; do
        printf '\n<details class="page" id="page-%s">\n<summary>%s</summary>\n' $page \
            "$(sed -n '1s/^# //p' "$build/docs/$page.md")"
        sed 1d "$build/docs/$page.md"
        printf '\n</details>\n'
    done
} | sed -e 's|\[\([^]]*\)\](\.\./figures/[^)]*)|\1|g' -e 's|(\.\./paper-repro\.md)|(#)|g' \
        -e 's|](\(docs/\)\{0,1\}[a-z]*\.md#|](#|g' -e 's|](\(docs/\)\{0,1\}\([a-z]*\)\.md)|](#page-\2)|g' >"$work/report.md"
cat "$here/page.css" >"$work/page.css"
{ printf 'window.avalanche = '; cat "$work/frames.json"; cat "$here/page.js"; } >"$work/page.js"
pandoc -f gfm -t html5 --self-contained --toc --toc-depth=3 --template "$here/page.html" \
    --metadata title='Angle of repose and forces under a pile' --resource-path ".:$work" -o "$build/report.html" "$work/report.md"
echo "report  $build/report.html"
