# Lee & Herrmann 1993, figure 1(a): 1600 grains, just before the right wall is removed. Line width between centres is
# proportional to the normal force, in twelve steps.
# sweeps: lh1
if (!exists('state')) { state = 'filled'; heading = 'Forces in a box of 1600 grains'; x_end = 8.4; y_end = 9; ratio = 9.3/8.8 }
legend = state eq 'pile' ? 3 : 2
load 'figures/style.gp'
contacts = t('lh1/row_0/'.state.'_contacts.tsv')
stats contacts using (column('normal_force')) nooutput name 'F'
set size ratio -1
set xlabel '{/:Italic x} (cm)'
set ylabel '{/:Italic y} (cm)'
set xrange [-0.4:x_end]
set yrange [-0.3:y_end]
unset grid
W = real(note('lh1/points.tsv', 'W'))
slope = 0
set arrow 1 from W, -0.3 to W, y_end nohead ls guide front
if (state eq 'pile') {
    # the measured slope, through the mean height of the surface in cells one diameter wide
    slope = most('lh1/row_0.tsv', 'theta_r3_deg')
    middle = real(system(rows_do('lh1/row_0/pile_grains.tsv', '', '$c["x"] > 0 && $c["x"] < '.sprintf('%g', W).' { k = int($c["x"]/0.2); h = $c["y"] + $c["r"]; if (h > m[k]) m[k] = h } END { for (k in m) { cells++; sum += m[k] } print sum/cells }')))
    rise = W/2*tan(slope*pi/180)
    set arrow 2 from 0, middle + rise to W, middle - rise nohead ls theory front
}
plot t('lh1/row_0/'.state.'_grains.tsv') using (column('x')):(column('y')):(column('r')) with circles lw 0.4 fs solid border lc rgb outline fc rgb grain notitle, \
     for [k=1:classes] contacts using (chain(column('normal_force'), F_max) == k ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors arrowstyle k notitle, \
     keyentry with lines lw thickest lc rgb darkest title sprintf('largest normal force, %.0f dyn', F_max), \
     keyentry with lines ls guide title 'the wall that is removed, at {/:Italic W}', \
     for [k=1:(state eq 'pile' ? 1 : 0)] keyentry with lines ls theory title sprintf('{/:Italic θ}_R = %.1f°', slope)
