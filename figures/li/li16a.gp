# Liffman, Chan & Hughes 1992, figure 16(a): the strongest contact of each disk with another disk, in the pile of 30
# degrees of 360 disks at eps = 1e-4.
# sweeps: pile
if (!exists('contact')) contact = 'strongest'
heading = 'The '.contact.' contact of each disk, pile of 30°'
across = 2
ratio = 15.0/46
shared = 1
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:14.5]
unset grid
plot t('pile/45_30_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.4 fs solid border lc rgb outline fc rgb grain notitle, \
     for [level=0:1] t('pile/45_30_1e-4/contacts.tsv') using (column(contact) > 0 && column('horizontal') == level ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors nohead lw 2.5 lc rgb level ? '#d55e00' : darkest \
       title level ? 'in a row' : 'along a diagonal'
