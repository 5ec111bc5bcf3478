# Liffman, Chan & Hughes 1992, figure 8: normal force on the base of the equilateral pile of 45 layers; hard disks
# by (42), soft disks at eps = 1e-4: the symmetric state, which is not stable, and three of the minima of the energy,
# one a panel.
# sweeps: pile triangle
soft = 'pile/45_60_1e-4.tsv'
heading = 'Normal force on the base of the equilateral pile'
remark = 'minima of the energy {/:Italic E} against the symmetric state'
panels = 3
shared = 2
load 'figures/style.gp'
minimum(k) = 'pile/minimum_45_60_1e-4_'.word('2 13 5', k).'.tsv'
below(k) = sprintf('(%s) a minimum, {/:Italic E} lower by %.1f {/:Italic mg}εσ', word('a b c', k), note(soft, 'energy') - note(minimum(k), 'energy'))
set xlabel '{/:Italic i}'
set ylabel '{/:Italic N} / {/:Italic mg}'
set xrange [0:46]
set yrange [22:24]
set ytics 22, 0.5, 24
do for [k=1:3] {
    eval panel(k, below(k))
    plot t('triangle/45.tsv') using (column('i')):(column('N/mg')) with lines ls theory title '(42), hard disks', \
         t(soft) using (column('i')):(column('N/mg')) with points ls 2 pt 4 title 'symmetric, '.note(soft, 'negative_modes').' negative modes', \
         t(minimum(k)) using (column('i')):(column('N/mg')) with linespoints ls ours title 'the minimum'
}
