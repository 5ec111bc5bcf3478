# Cost of an angle of repose: bias against the finest setting, and processor time for a standard error of one degree,
# for sizes of the box, time steps and thresholds of rest.
# tables: val_cost_degree.tsv
heading = 'Cost of an angle of repose against its bias'
remark = 'bars: standard error; rest: kinetic energy of a grain below this number of {/:Italic m g d}; time for {/:Italic x}°: divided by {/:Italic x}^2'
legend = 8
load 'figures/style.gp'
data = t('val_cost_degree.tsv')
widths = '2 3 4'
colours = '#000000 #0072b2 #d55e00'
array rests[3] = [1e-3, 1e-5, 1e-7]
of(W, dt, rest, col) = column('W') == W && abs(column('dt')/dt - 1) < 0.1 && abs(column('rest_energy')/rest - 1) < 0.1 ? column(col) : NaN
set logscale x
set xlabel 'time for a standard error of 1° (s)'
set ylabel '{/:Italic θ}_R minus the finest (degrees)'
set yrange [-5.5:3]
set xrange [0.7:100]
set xzeroaxis ls guide
plot for [w = 1:3] for [r = 1:3] for [d = 1:2] data using \
       (of(real(word(widths, w)), 5e-5/d, rests[r], 'cost')): \
       (of(real(word(widths, w)), 5e-5/d, rests[r], 'bias')):(column('bias_se')) \
       with yerrorbars pt int(word('6 7 4 5 8 9', 2*r - 2 + d)) ps 0.7 lc rgb word(colours, w) notitle, \
     for [w=1:3] keyentry with points pt 7 ps 0.7 lc rgb word(colours, w) title sprintf('{/:Italic W} = {/:Italic H} = %s cm', word(widths, w)), \
     for [r=1:3] keyentry with points pt int(word('7 5 9', r)) ps 0.7 lc rgb '#000000' title sprintf('rest: %.0e', rests[r]), \
     keyentry with points pt 6 ps 0.7 lc rgb '#000000' title 'open: {/:Italic dt} = 5e-5 s', \
     keyentry with points pt 7 ps 0.7 lc rgb '#000000' title 'filled: 2.5e-5 s'
