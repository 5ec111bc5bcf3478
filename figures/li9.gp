# Liffman, Chan & Hughes 1992, figure 9: horizontal force on the base of the equilateral pile of 45 layers; hard
# disks by (44), soft disks at eps = 1e-4 in the symmetric state and in a minimum of the energy.
set xlabel '{/:Italic i}'
set ylabel '{/:Italic H} / {/:Italic mg}'
set xrange [0:46]
set yrange [-15:15]
set key top left Left reverse font ',9'
plot t('triangle_45.tsv') using (column('i')):(column('H/mg')) with lines lw 1.5 lc 1 title '(44), hard disks', \
     t('pile_45_60_1e-4.tsv') using (column('i')):(column('H/mg')) with points pt 6 ps 0.6 lc 2 title 'ε = 10^{-4}, symmetric', \
     t('pile_minimum_45_60_1e-4.tsv') using (column('i')):(column('H/mg')) with points pt 8 ps 0.6 lc 3 title 'ε = 10^{-4}, a minimum'
