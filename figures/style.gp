# Common style of all figures: the only place of sizes, fonts, colours and symbols. Called with folders (of tables),
# sweeps (those that the figure names), terminal and file set.
# A figure sets some of these and loads this file again:
#   heading    what the figure shows, in bold; `remark`: what its bars and marks mean. A page says both beside a shown one
#   panels     how many (1); two stand side by side, and more go on below
#   legend     entries of the key above each panel (0); `shared`: of one key above all panels
#   sample     length of a line in the key (1.5); 0 where the key has marks alone
#   across     columns of a journal that a panel spans (1); `ratio`: its height over its width
# Each of several panels begins with `eval panel(K, NAME)`.
set encoding utf8
if (!exists('heading')) heading = ''
if (!exists('remark')) remark = ''
if (!exists('panels')) panels = 1
if (!exists('legend')) legend = 0
if (!exists('shared')) shared = 0
if (!exists('across')) across = 1
if (!exists('sample')) sample = 1.5

# Sizes in cm. A column of a journal is 8.6 cm wide. Letters of 8.8 pt leave indices at 7 pt.
# svg takes letters for 1.22 times as tall as the others do, and for wider.
svg = terminal eq 'svg'
letters = 8.8
line_height = 0.42
left_margin = svg ? 2.2 : 1.85
right_margin = 0.4
panel_width = 8.6*across - left_margin - right_margin
panel_height = exists('ratio') ? ratio*panel_width : 4.6
named = panels > 1
columns = panels > 1 && across == 1 ? 2 : 1
width = 8.6*across*columns
breaks(s, n) = n < 2 || (s[n:n] eq ' ' && s[n - 6:n - 1] ne 'Italic') ? n : breaks(s, n - 1)
marks(s) = strstrt(s, '{/:Italic') ? 1 + marks(s[strstrt(s, '{/:Italic') + 9:*]) : 0
room(s, n) = n + 11*marks(s[1:n])
fold(s, n, between) = strlen(s) <= room(s, n) ? s : s[1:breaks(s, room(s, n)) - 1].between.fold(s[breaks(s, room(s, n)) + 1:*], n, between)
lines(s) = s eq '' ? 0 : 1 + (strstrt(s, "\n") ? lines(s[strstrt(s, "\n") + 1:*]) : 0)
heading = fold(heading, int(5.2*width), "}\n{/:Bold ")
remark = fold(remark, int(5.6*width), "\n")
if (terminal eq 'shown') { heading = ''; remark = '' }
top = line_height*(lines(heading) + lines(remark) + shared) + 0.25
cell_height = line_height*(legend + named) + 0.3 + panel_height + 1.15
height = top + cell_height*ceil(1.0*panels/columns)

# Lines, points and letters of all terminals have the size that they have in svg, at 96 dots an inch. png: 600 dots; shown, for pages: 180.
dots = terminal eq 'pdf' ? 72. : terminal eq 'png' ? 600. : 180.
font = sprintf('DejaVu Sans,%g', letters)
if (terminal eq 'svg') set terminal svg size width*96/2.54, height*96/2.54 font sprintf('DejaVu Sans,%g', letters*96/72) background 'white' enhanced
if (terminal eq 'pdf') set terminal pdfcairo size width cm, height cm font font fontscale dots/96 linewidth dots/96 pointscale dots/96 enhanced
if (terminal eq 'png' || terminal eq 'shown') set terminal pngcairo size width*dots/2.54, height*dots/2.54 font font fontscale dots/96 linewidth dots/96 pointscale dots/96 enhanced
set output file.(terminal eq 'shown' ? '.png' : '.'.terminal)

# Measured values: black, or these marks. Theory: lines in colour, drawn first. The papers' numbers: one symbol.
# The colours differ for the colour-blind.
ours = 1
theory = 11
paper = 20
guide = 10
set style line 1 lc rgb '#000000' pt 7 ps 0.45 lw 1
set style line 2 lc rgb '#0072b2' pt 5 ps 0.45 lw 1
set style line 3 lc rgb '#009e73' pt 9 ps 0.6 lw 1
set style line 4 lc rgb '#cc79a7' pt 11 ps 0.6 lw 1
set style line 5 lc rgb '#e69f00' pt 15 ps 0.55 lw 1
set style line 6 lc rgb '#000000' pt 6 ps 0.45 lw 1
set style line 10 lc rgb '#888888' lw 1 dt (4, 3) pt 2 ps 0.5
set style line 11 lc rgb '#e69f00' lw 2 pt 4 ps 0.6
set style line 12 lc rgb '#0072b2' lw 1.5 dt (8, 3) pt 8 ps 0.7
set style line 13 lc rgb '#009e73' lw 1.5 dt (3, 2) pt 10 ps 0.7
set style line 14 lc rgb '#cc79a7' lw 1.5 dt (8, 2, 2, 2) pt 14 ps 0.7
set style line 20 lc rgb '#d55e00' pt 13 ps 0.8 lw 1.5
# Force chains are dark on pale grains, as `repose view` draws them: class k of `classes` is as wide as its force.
# src/view/draw.c reads the same file as C.
load 'figures/chains.gp'
thickest = 3
darkest = sprintf('#%02x%02x%02x', dark_r, dark_g, dark_b)
chain(f, most) = f > 0 ? ceil(classes*f/most) : 0
shade(k, pale, dark) = int(pale + (dark - pale)*(k - 1.0)/(classes - 1))
do for [k=1:classes] { set style arrow k nohead lw thickest*(k - 0.5)/classes lc rgb sprintf('#%02x%02x%02x', shade(k, pale_r, dark_r), shade(k, pale_g, dark_g), shade(k, pale_b, dark_b)) }

set datafile missing 'nan'
set border lw 0.7
set tics scale 0.6 nomirror out
set xtics offset 0, 0.3
set ytics offset 0.4, 0
upwards = svg ? 0.95 : 0.6
aside = svg ? 1.4 : 0.4
set xlabel offset 0, upwards
set ylabel offset aside, 0
# of labels beside tics that are powers of ten, whose markup gnuplot counts
powers = 1.8
set format '%h'
set samples 1001
set bars small
set pointintervalbox 0.01
if (heading ne '') set label 91 "{/:Bold ".heading."}" at screen 0.3/width, screen 1 - (0.1 + 0.5*line_height)/height
if (remark ne '') set label 92 remark at screen 0.3/width, screen 1 - (0.1 + line_height*(lines(heading) + 0.5))/height
from_left(k) = 8.6*across*((k - 1) % columns) + left_margin
from_top(k) = top + cell_height*((k - 1)/columns) + line_height*(legend + named) + 0.3
place(k) = sprintf('set lmargin at screen %g; set rmargin at screen %g; set tmargin at screen %g; set bmargin at screen %g;', \
                   from_left(k)/width, (from_left(k) + panel_width)/width, 1 - from_top(k)/height, 1 - (from_top(k) + panel_height)/height)
key_at(k) = shared ? sprintf('set key at screen %g, screen %g', 0.1/width, 1 - top/height) \
                   : sprintf('set key at screen %g, screen %g', (from_left(k) - left_margin + 0.1)/width, 1 - (from_top(k) - 0.2)/height)
key(k) = shared && k > 1 ? 'unset key;' : key_at(k).sprintf(' left bottom Left reverse samplen %g spacing %g maxrows %d;', sample, svg ? 0.9 : 1.1, shared + legend)
name_at(k, name) = name eq '' ? '' : sprintf("set label 90 '%s' at screen %g, screen %g;", name, (from_left(k) - left_margin + 0.3)/width, \
                                        1 - (from_top(k) - 0.3 - line_height*(legend + 0.5))/height)
panel(k, name) = (k > 1 ? 'unset label 91; unset label 92;' : '').place(k).key(k).name_at(k, name)
eval panel(1, '')
if (panels > 1) set multiplot

# A table of this project for gnuplot: the last header line becomes the names of the columns.
set datafile separator tab
set datafile columnheaders
# The first table SWEEP/NAME in the folders. A figure's file names its sweeps after "# sweeps:", for `make`, and reads no others.
found(name) = system('for folder in '.folders.'; do path=$folder/'.name.'; [ ! -e $path ] || break; done; echo $path')
path(name) = strstrt(' '.sweeps.' ', ' '.name[1:strstrt(name, '/') - 1].' ') ? found(name) : not_of_a_sweep_that_the_figure_names
# The text after "# KEY: " in the header of a table, without a unit.
note(name, key) = system("sed -n 's/^# ".key.": \\([^ ]*\\).*/\\1/p' ".path(name))
within(a, b, x, y) = a <= x && x <= b ? y : NaN
t(name) = "< grep -v '^#' ".path(name)
# awk over its rows: $c["COLUMN"] is a cell, and v the value, a word or a number.
rows_do(name, first, each) = "awk -F'\t' '/^#/ { next } !n { n = NF; for (i = 1; i <= n; i++) c[$i] = i; ".first."next } ".each."' ".path(name)
is(key, value) = '($c["'.key.'"] "" == "'.value.'" || ("'.value.'" + 0 && $c["'.key.'"] + 0 == "'.value.'" + 0))'
# The rows whose column KEY is VALUE; the cell of their column COL; the largest number of a column.
rows(name, key, value) = '< '.rows_do(name, 'print; ', is(key, value))
pick(name, key, value, col) = system(rows_do(name, '', is(key, value).' { print $c["'.col.'"]; exit }'))
most(name, col) = real(system(rows_do(name, '', '$c["'.col.'"] > m { m = $c["'.col.'"] } END { print m }')))
# Column COL of a table less that of another, a line of the same x/B from 0 to 1: columns x and less.
less(name, line, col) = "< awk -F'\t' 'FNR == 1 { file++; head = 1 } /^#/ { next } head { for (i = 1; i <= NF; i++) c[file, $i] = i; head = 0; if (file == 2) print \"x\tless\"; next } ".\
    "file == 1 { n++; x[n] = $c[1, \"x/B\"]; f[n] = $c[1, \"".col."\"]; next } { at = $c[2, \"x/B\"]; if (k < 1) k = 1; while (k < n - 1 && x[k + 1] < at) k++; ".\
    "print at \"\t\" $c[2, \"".col."\"] - f[k] - (f[k + 1] - f[k])*(at - x[k])/(x[k + 1] - x[k]) }' ".path(line).' '.path(name)
# A published number: column published or published_se of the claim ID; rows of a table of them.
published(id, col) = real(pick('claims/published.tsv', 'id', id, col))
printed(x, id) = sprintf("%s\t%.17g\t%.17g", x, published(id, 'published'), published(id, 'published_se'))
