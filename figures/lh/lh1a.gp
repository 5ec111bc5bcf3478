# Lee & Herrmann 1993, figure 1(a): 1600 grains, just before the right wall is removed. Line width between centres is
# proportional to the normal force, in twelve steps.
# sweeps: lh1
if (!exists('state')) { state = 'filled'; heading = 'Forces in a box of 1600 grains'; x_end = 8.4; y_end = 9; ratio = 9.3/8.8 }
legend = 1
load 'figures/style.gp'
contacts = t('lh1/row_0/'.state.'_contacts.tsv')
stats contacts using (column('normal_force')) nooutput name 'F'
set size ratio -1
set xlabel '{/:Italic x} (cm)'
set ylabel '{/:Italic y} (cm)'
set xrange [-0.4:x_end]
set yrange [-0.3:y_end]
unset grid
plot t('lh1/row_0/'.state.'_grains.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.4 fs solid border lc rgb outline fc rgb grain notitle, \
     for [k=1:classes] contacts using (chain(column('normal_force'), F_max) == k ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors arrowstyle k notitle, \
     keyentry with lines lw thickest lc rgb darkest title sprintf('largest normal force, %.0f dyn', F_max)
