# Liffman, Chan & Hughes 1992, figure 9: horizontal force on the base of the equilateral pile of 45 layers; hard disks
# by (44), soft disks at eps = 1e-4 in the symmetric state and in minima of the energy. Below: difference between soft
# and hard disks.
# tables: pile_45_60_1e-4.tsv pile_minimum_45_60_1e-4_13.tsv pile_minimum_45_60_1e-4_2.tsv triangle_45.tsv
height = 11.0
load 'figures/style.gp'
set multiplot layout 2, 1
set xlabel '{/:Italic i}'
set xrange [0:46]
set ylabel '{/:Italic H} / {/:Italic mg}'
set yrange [-15:15]
set key top left Left reverse font ',9'
plot t('triangle_45.tsv') using (column('i')):(column('H/mg')) with lines lw 1.5 lc 1 title '(44), hard disks', \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('H/mg')) with points pt 6 ps 0.6 lc 2 title 'ε = 10^{-4}, symmetric', \
     t('pile_minimum_45_60_1e-4_2.tsv') using (column('i')):(column('H/mg')) with points pt 8 ps 0.6 lc 3 title 'ε = 10^{-4}, a minimum'
set ylabel '({/:Italic H} - {/:Italic H}_{(44)}) / {/:Italic mg}'
set yrange [-0.6:1]
set key top center maxrows 1 font ',9'
change = 'column("H/mg") - column("H_diagonals/mg")'
plot t('pile_45_60_1e-4.tsv') using (column('i')):(@change) with points pt 6 ps 0.6 lc 2 title 'symmetric', \
     t('pile_minimum_45_60_1e-4_2.tsv') using (column('i')):(@change) with lines lw 1 lc 3 title 'the minimum of the upper panel', \
     t('pile_minimum_45_60_1e-4_13.tsv') using (column('i')):(@change) with lines lw 1 dt 2 lc 4 title 'another minimum'
unset multiplot
