# Liffman, Chan & Hughes 1992, figure 8: normal force on the base of the equilateral pile of 45 layers; hard disks
# by (42), soft disks at eps = 1e-4: the symmetric state, which is not stable, and three of the minima of the energy,
# one a panel.
# tables: pile_45_60_1e-4.tsv pile_minimum_45_60_1e-4_13.tsv pile_minimum_45_60_1e-4_2.tsv
#    pile_minimum_45_60_1e-4_5.tsv triangle_45.tsv
height = 11.0
load 'figures/style.gp'
soft = 'pile_45_60_1e-4.tsv'
symmetric = 'symmetric, '.note(soft, 'negative_modes').' negative modes'
below(name) = sprintf('a minimum, {/:Italic E} lower by %.1f {/:Italic mg}εσ', note(soft, 'energy') - note(name, 'energy'))
set multiplot layout 3, 1
set ylabel '{/:Italic N} / {/:Italic mg}'
set xrange [0:46]
set yrange [22:24.4]
set ytics 22, 0.5, 24
set key top center maxrows 2 font ',8' samplen 1.5
plot t('triangle_45.tsv') using (column('i')):(column('N/mg')) with lines lw 1.5 lc 1 title '(42), hard disks', \
     t('pile_minimum_45_60_1e-4_2.tsv') using (column('i')):(column('N/mg')) with linespoints lw 0.7 pt 8 ps 0.5 lc 3 \
       title below('pile_minimum_45_60_1e-4_2.tsv'), \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('N/mg')) with points pt 6 ps 0.6 lc 2 title symmetric
plot t('triangle_45.tsv') using (column('i')):(column('N/mg')) with lines lw 1.5 lc 1 notitle, \
     t('pile_minimum_45_60_1e-4_13.tsv') using (column('i')):(column('N/mg')) with linespoints lw 0.7 pt 8 ps 0.5 lc 3 \
       title below('pile_minimum_45_60_1e-4_13.tsv'), \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('N/mg')) with points pt 6 ps 0.6 lc 2 notitle
set xlabel '{/:Italic i}'
plot t('triangle_45.tsv') using (column('i')):(column('N/mg')) with lines lw 1.5 lc 1 notitle, \
     t('pile_minimum_45_60_1e-4_5.tsv') using (column('i')):(column('N/mg')) with linespoints lw 0.7 pt 8 ps 0.5 lc 3 \
       title below('pile_minimum_45_60_1e-4_5.tsv'), \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('N/mg')) with points pt 6 ps 0.6 lc 2 notitle
unset multiplot
