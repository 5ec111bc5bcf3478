# Liffman, Chan & Hughes 1992, figure 15: piles of 30 degrees of 360 and 5490 disks at eps = 1e-4, and of 21780 in the limit
# eps -> 0, against the continuum (54)-(59).
# tables: continuum_30.tsv pile_180_30_1e-4.tsv pile_360_30_0.tsv pile_45_30_1e-4.tsv
width = 18.0
height = 8.0
load 'figures/style.gp'
set multiplot layout 1, 2
set xlabel '{/:Italic x / B}'
set xrange [0:1]
set key bottom center font ',9'
set ylabel '{/:Italic N} / ({/:Italic χgB})'
set yrange [0:0.33]
set title '(a)'
curves = "t('continuum_30.tsv') using (column('x/B')):(column(q)) with lines lw 2 lc 1 title 'continuum', ".\
         "t('pile_45_30_1e-4.tsv') using (column('x/B')):(column(q)) with points pt 6 ps 0.6 lc 7 title '360 disks', ".\
         "t('pile_360_30_0.tsv') using (column('x/B')):(column(q)) with lines lw 2.5 lc 2 title '21780 disks, ε → 0', ".\
         "t('pile_180_30_1e-4.tsv') using (column('x/B')):(column(q)) with lines lw 0.8 dt (8,5) lc 6 title '5490 disks'"
q = 'N/(chi*g*B)'
eval 'plot '.curves
set ylabel '{/:Italic H} / ({/:Italic χgB})'
set yrange [-0.07:0.07]
set key top left Left reverse
set title '(b)'
q = 'H/(chi*g*B)'
eval 'plot '.curves
unset multiplot
