# Liffman, Chan & Hughes 1992, figure 8: normal force on the base of the equilateral pile of 45 layers; hard disks
# by (42), soft disks at eps = 1e-4: the symmetric state, which is not stable, and one of the minima of the energy.
# sweeps: pile triangle
soft = 'pile/45_60_1e-4.tsv'
minimum = 'pile/minimum_45_60_1e-4_2.tsv'
heading = 'Normal force on the base of the equilateral pile'
remark = sprintf('energy of the minimum: lower by %.1f {/:Italic mg}εσ than that of the symmetric state', note(soft, 'energy') - note(minimum, 'energy'))
legend = 4
load 'figures/style.gp'
set xlabel '{/:Italic i}'
set ylabel '{/:Italic N} / {/:Italic mg}'
set xrange [0:46]
set yrange [22:24]
set ytics 22, 0.5, 24
plot t('triangle/45.tsv') using (column('i')):(column('N/mg')) with lines ls theory title '(42), hard disks', \
     for [k=0:1] '' using (column('i')):(column('N/mg')*(1 + 0.01*(2*k - 1))) with lines ls guide title k ? '' : 'the same ± 1 %', \
     t(soft) using (column('i')):(column('N/mg')) with points ls 2 pt 4 title 'soft disks, symmetric, '.note(soft, 'negative_modes').' negative modes', \
     t(minimum) using (column('i')):(column('N/mg')) with linespoints ls ours title 'soft disks, a minimum of the energy'
