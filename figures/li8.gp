# Liffman, Chan & Hughes 1992, figure 8: normal force on the base of the equilateral pile of 45 layers; hard disks
# by (42), soft disks at eps = 1e-4: the symmetric state, which is not stable, and a minimum of the energy.
set xlabel '{/:Italic i}'
set ylabel '{/:Italic N} / {/:Italic mg}'
set xrange [0:46]
set yrange [22.2:23.8]
set key top center maxrows 3 font ',9'
soft = 'pile_45_60_1e-4.tsv'
plot t('triangle_45.tsv') using (column('i')):(column('N/mg')) with lines lw 1.5 lc 1 title '(42), hard disks', \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('N/mg')) with points pt 6 ps 0.6 lc 2 \
       title 'ε = 10^{-4}, symmetric, '.note(soft, 'negative_modes').' negative modes', \
     t('pile_minimum_45_60_1e-4.tsv') using (column('i')):(column('N/mg')) with points pt 8 ps 0.6 lc 3 \
       title 'ε = 10^{-4}, a minimum'
