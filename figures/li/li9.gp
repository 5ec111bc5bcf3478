# Liffman, Chan & Hughes 1992, figure 9: horizontal force on the base of the equilateral pile of 45 layers; hard disks
# by (44), soft disks at eps = 1e-4 in the symmetric state and in minima of the energy. (b): difference between soft
# and hard disks.
# sweeps: pile triangle
heading = 'Horizontal force on the base of the equilateral pile'
panels = 2
legend = 3
load 'figures/style.gp'
set xlabel '{/:Italic i}'
set xrange [0:46]
eval panel(1, '(a) force; ε = 10^{-4}')
set ylabel '{/:Italic H} / {/:Italic mg}'
set yrange [-15:15]
plot t('triangle/45.tsv') using (column('i')):(column('H/mg')) with lines ls theory title '(44), hard disks', \
     t('pile/45_60_1e-4.tsv') using (column('i')):(column('H/mg')) with points ls 2 pt 4 title 'symmetric', \
     t('pile/minimum_45_60_1e-4_2.tsv') using (column('i')):(column('H/mg')) with points ls ours title 'a minimum'
eval panel(2, '(b) difference from (44)')
set ylabel '({/:Italic H} - {/:Italic H}_{(44)}) / {/:Italic mg}'
set yrange [-0.6:0.6]
change = 'column("H/mg") - column("H_diagonals/mg")'
plot t('pile/45_60_1e-4.tsv') using (column('i')):(@change) with points ls 2 pt 4 title 'symmetric', \
     t('pile/minimum_45_60_1e-4_2.tsv') using (column('i')):(@change) with linespoints ls ours title 'the minimum of (a)', \
     t('pile/minimum_45_60_1e-4_13.tsv') using (column('i')):(@change) with lines ls 13 title 'another minimum'
