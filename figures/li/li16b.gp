# Liffman, Chan & Hughes 1992, figure 16(b): the weakest contact of each disk with another disk, in the pile of 30
# degrees of 360 disks at eps = 1e-4.
# tables: pile_45_30_1e-4/contacts.tsv pile_45_30_1e-4/disks.tsv
width = 18.0
height = 7.0
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:14.5]
unset grid
set key above
contacts = t('pile_45_30_1e-4/contacts.tsv')
plot t('pile_45_30_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.3 fs empty border lc rgb '#c8c8c8' notitle, \
     for [level = 0:1] contacts using (column('weakest') > 0 && column('horizontal') == level ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors nohead lw 1.4 lc (level ? 7 : 3) notitle, \
     NaN with lines lw 1.4 lc 3 title 'the weakest contact of a disk, along a diagonal', NaN with lines lw 1.4 lc 7 title 'in a row'
