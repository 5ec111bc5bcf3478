# Liffman, Chan & Hughes 1992, figure 12: the pile of 55 degrees, 45 disks in its base, in equilibrium at eps = 1e-4.
# sweeps: pile
heading = 'Pile of 55° with 45 disks in its base'
legend = 1
ratio = 33.5/46
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:33]
unset grid
plot t('pile/45_55_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.5 fs solid border lc rgb outline fc rgb grain notitle, \
     (x < 22 ? x : 44 - x)*tan(55*pi/180) + 0.5 with lines ls theory title '55°, through the outermost centres'
