# Growth of a shift of one grain by 1e-15 cm after a box at rest is opened.
# sweeps: chaos
runs(dt, shift, seed) = sprintf("< awk -F'\t' '/^#/ { next } !n++ { print; next } $1 + 0 == %s && $2 + 0 == %s && $3 == %d' ", dt, shift, seed).path('chaos/chaos.tsv')
cell(row, col) = real(system(sprintf("awk -F'\t' '!/^#/ && n++ == %d { print $%d }' ", row, col).path('chaos/fit.tsv')))
rate = cell(1, 4)
seeds = int(cell(1, 3))
heading = 'Growth of a shift of one grain by 10^{-15} cm'
remark = sprintf('growth (1/s), %d boxes: %.0f ± %.0f at the larger step, %.0f ± %.0f at the smaller; bold: mean of the fits at the larger', seeds, cell(1, 4), cell(1, 5), cell(2, 4), cell(2, 5))
legend = 2
load 'figures/style.gp'
set logscale y
set format y '10^{%T}'
set ylabel offset powers
set xlabel 'time since the opening (s)'
set ylabel 'rms distance (diameters)'
set xrange [0:0.2]
set yrange [1e-17:1e3]
set ytics 1e3
plot for [s=0:seeds - 1] runs('2.5e-05', '1e-15', s) using (column('t')):(column('distance')) with lines lw 0.6 lc rgb '#0072b2' title s ? '' : 'd{/:Italic t} = 2.5 × 10^{-5} s', \
     for [s=0:seeds - 1] runs('5e-05', '1e-15', s) using (column('t')):(column('distance')) with lines lw 0.6 lc rgb '#000000' title s ? '' : 'd{/:Italic t} = 5 × 10^{-5} s', \
     within(0.01, 0.11, x, 3e-16*exp(rate*x)) with lines ls theory lw 3 notitle
