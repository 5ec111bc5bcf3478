# Liffman, Chan & Hughes 1992, figure 12: the pile of 55 degrees, 45 disks in its base, in equilibrium at eps = 1e-4.
# tables: pile_45_55_1e-4/disks.tsv
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:33]
unset grid
set samples 1001
set key above
plot t('pile_45_55_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.5 lc 3 fs solid 0.2 border notitle, \
     (x < 22 ? x : 44 - x)*tan(55*pi/180) + 0.5 with lines lw 1.2 lc 7 title '55°, through the outermost centres of the base'
