# Liffman, Chan & Hughes 1992, figure 10(a): the strongest contact of each disk with another disk, in the equilateral
# pile of 45 layers at eps = 1e-4, symmetric state.
# sweeps: pile
if (!exists('contact')) contact = 'strongest'
heading = 'The '.contact.' contact of each disk'
ratio = 40.0/46
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x} / σ'
set ylabel '{/:Italic y} / σ'
set xrange [-1:45]
set yrange [-0.5:39.5]
unset grid
plot t('pile/45_60_1e-4/disks.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.4 fs solid border lc rgb outline fc rgb grain notitle, \
     t('pile/45_60_1e-4/contacts.tsv') using (column(contact) > 0 ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors nohead lw 1.5 lc rgb darkest notitle
