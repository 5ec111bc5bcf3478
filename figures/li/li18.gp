# Liffman, Chan & Hughes 1992, figure 18: outlines of tents.
# tables: tent_30_45_38.tsv tent_45_30_38.tsv
width = 16.0
height = 5.0
load 'figures/style.gp'
set multiplot layout 1, 2
set size ratio -1
set xlabel '{/:Italic x / B}'
set ylabel '{/:Italic y / B}'
set xrange [0:1]
set yrange [0:0.5]
set ytics 0.1
set title '(a) α_1 = 45°, α_2 = 30°'
plot t('tent_45_30_38.tsv') using (column('x/B')):(column('y/B')) with filledcurves y1=0 lc 3 fs solid 0.25 noborder notitle, '' using (column('x/B')):(column('y/B')) with lines lc 3 lw 1.5 notitle
set title '(b) α_1 = 30°, α_2 = 45°'
plot t('tent_30_45_38.tsv') using (column('x/B')):(column('y/B')) with filledcurves y1=0 lc 3 fs solid 0.25 noborder notitle, '' using (column('x/B')):(column('y/B')) with lines lc 3 lw 1.5 notitle
unset multiplot
