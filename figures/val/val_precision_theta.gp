# Cost of an angle of repose: bias against the finest setting, and processor time for a standard error of one degree,
# for sizes of the box, time steps and thresholds of rest.
# tables: val_cost_degree.tsv
load 'figures/style.gp'
data = t('val_cost_degree.tsv')
widths = '2 3 4'
array rests[3] = [1e-3, 1e-5, 1e-7]
of(W, dt, rest, col) = column('W') == W && abs(column('dt')/dt - 1) < 0.1 && abs(column('rest_energy')/rest - 1) < 0.1 ? column(col) : NaN
set logscale x
set xlabel 'time for a standard error of 1° (s); of {/:Italic x}°: divided by {/:Italic x}^2'
set ylabel 'mean {/:Italic θ}_R minus that of the finest setting (°)'
set yrange [-5.5:3]
set xrange [0.7:100]
set key bottom right Left reverse font ',7' samplen 1
set xzeroaxis lt 1 lw 0.5 lc rgb '#808080'
plot for [w = 1:3] for [r = 1:3] for [d = 1:2] data using \
       (of(real(word(widths, w)), 5e-5/d, rests[r], 'cost')): \
       (of(real(word(widths, w)), 5e-5/d, rests[r], 'bias')):(column('bias_se')) \
       with yerrorbars pt int(word('6 7 4 5 8 9', 2*r - 2 + d)) ps 0.8 lw 0.7 lc int(word('2 3 7', w)) notitle, \
     for [w = 1:3] NaN with points pt 7 ps 0.8 lc int(word('2 3 7', w)) title sprintf('{/:Italic W} = {/:Italic H} = %s cm', word(widths, w)), \
     for [r = 1:3] NaN with points pt int(word('7 5 9', r)) ps 0.8 lc 1 title sprintf('rest: energy below %.0e {/:Italic m g d}', rests[r]), \
     NaN with points pt 6 ps 0.8 lc 1 title 'open: {/:Italic dt} = 5e-5 s', NaN with points pt 7 ps 0.8 lc 1 title 'filled: 2.5e-5 s', \
     NaN with lines lc 1 lw 0.7 title 'bars: standard error'
