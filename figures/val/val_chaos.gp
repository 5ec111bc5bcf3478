# Growth of a shift of one grain by 1e-15 cm after a box at rest is opened.
# tables: validation_chaos.tsv validation_chaos_fit.tsv
load 'figures/style.gp'
runs(dt, shift, seed) = sprintf("< awk -F'\t' '/^#/ { next } !n++ { print; next } $1 + 0 == %s && $2 + 0 == %s && $3 == %d' ", dt, shift, seed).path('validation_chaos.tsv')
cell(row, col) = real(system(sprintf("awk -F'\t' '!/^#/ && n++ == %d { print $%d }' ", row, col).path('validation_chaos_fit.tsv')))
rate = cell(1, 4)
seeds = int(cell(1, 3))
set logscale y
set format y '10^{%T}'
set xlabel 'time since the opening (s)'
set ylabel 'rms distance of the two runs (diameters)'
set xrange [0:0.2]
set yrange [1e-17:1e3]
set ytics 1e3
set key bottom right Left reverse font ',7.5'
set label 1 sprintf('rates of growth (1/s), mean ± standard error over %d boxes:', seeds) at graph 0.03, 0.96 font ',7.5'
set label 2 sprintf('%.0f ± %.0f at d{/:Italic t} = 5 × 10^{-5} s, %.0f ± %.0f at 2.5 × 10^{-5} s', cell(1, 4), cell(1, 5), cell(2, 4), cell(2, 5)) at graph 0.03, 0.90 font ',7.5'
plot for [s = 0:seeds - 1] runs('2.5e-05', '1e-15', s) using (column('t')):(column('distance')) with lines lw 0.6 lc 3 notitle, \
     for [s = 0:seeds - 1] runs('5e-05', '1e-15', s) using (column('t')):(column('distance')) with lines lw 0.6 lc 2 notitle, \
     NaN with lines lc 2 title 'd{/:Italic t} = 5 × 10^{-5} s', \
     NaN with lines lc 3 title 'd{/:Italic t} = 2.5 × 10^{-5} s', \
     [0.01:0.11] 3e-16*exp(rate*x) with lines lw 2 dt 2 lc 1 title 'mean of the fits at 5 × 10^{-5} s, from 10 × first distance to 10^{-3}'
