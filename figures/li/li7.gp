# Liffman, Chan & Hughes 1992, figure 7: the equilateral pile of 1035 disks, in equilibrium at eps = 1e-4.
# sweeps: pile
heading = 'Equilateral pile of 1035 disks'
ratio = 40.0/46
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:39.5]
unset grid
plot t('pile/45_60_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.5 fs solid border lc rgb outline fc rgb grain notitle
