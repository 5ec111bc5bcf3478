# Common style of all figures. Called with T (folder of the tables), tables (those that the figure lists), terminal and file set.
# Colours: gnuplot's podo sequence, safe for colour-blind readers; marks differ in shape too.
if (!exists("width")) width = 12.0    # cm
if (!exists("height")) height = 8.5
font = 'DejaVu Sans'
if (terminal eq 'svg') set terminal svg size width*37.8, height*37.8 font font.',11' background 'white' enhanced
if (terminal eq 'pdf') set terminal pdfcairo size width cm, height cm font font.',8' enhanced
if (terminal eq 'png') set terminal pngcairo size width*80, height*80 font font.',11' fontscale 1.5 linewidth 2 enhanced
# Small, for pages: two thirds of the PNG, with as much text.
if (terminal eq 'shown') set terminal pngcairo size width*54, height*54 font font.',11' linewidth 1.4 enhanced
set output file.(terminal eq 'shown' ? '.png' : '.'.terminal)
set colorsequence podo
set datafile missing 'nan'
set border lw 0.7
set tics scale 0.6 nomirror out
set grid lw 0.3 lc rgb '#d8d8d8'
set key spacing 1.2 samplen 2.5
set bars small
# A table of this project for gnuplot: the last header line becomes the names of the columns.
set datafile separator tab
set datafile columnheaders
# Where a table is. A figure's file lists its tables after "# tables:", for `make`, and reads no others.
path(name) = strstrt(' '.tables.' ', ' '.name.' ') ? T.name : not_named_after_tables_in_the_figure
# The text after "# KEY: " in the header of a table, without a unit.
note(name, key) = system("sed -n 's/^# ".key.": \\([^ ]*\\).*/\\1/p' ".path(name))
# A cell of such a table: column COL of the row whose column KEY is the number VALUE.
pick(name, key, value, col) = system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, \"\t\"); for (i = 1; i <= n; i++) c[a[i]] = i; next } $c[\"".key."\"] + 0 == ".value." { print $c[\"".col."\"] }' ".path(name))
t(name) = "< grep -v '^#' ".path(name)
# A published number: column published or published_se of the claim ID.
published(id, col) = real(system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, \"\t\"); for (i = 1; i <= n; i++) c[a[i]] = i; next } $1 == \"".id."\" { print $c[\"".col."\"] }' ".path("published.tsv")))
