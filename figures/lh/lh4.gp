# Lee & Herrmann 1993, figure 4: tilting angle against friction.
# sweeps: lh3 lh3_box
heading = 'Tilting angle against friction'
remark = sprintf('%s degree per step; bars: standard error over %d piles, %d in the turned box; series shifted sideways', note('lh3/points.tsv', 'tilt_rate_deg'), most('lh3/points.tsv', 'n'), most('lh3_box/compare.tsv', 'n'))
legend = 4
load 'figures/style.gp'
fit = 'lh3/fit_theta_t.tsv'
slope = real(pick(fit, 'line', 'free', 'slope'))
start = real(pick(fit, 'line', 'free', 'intercept'))
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:10]
plot within(0.05, 0.2, x, start + slope*x) with lines ls theory title 'straight line, 0.05 ≤ {/:Italic μ} ≤ 0.2', \
     t('lh3/points.tsv') using (column('mu') + 0.003):(column('theta_t_energy_deg_mean')):(column('theta_t_energy_deg_se')) \
       with yerrorbars ls 2 title 'energy above 10^{-5} {/:Italic mgd} a grain', \
     '' using (column('mu')):(column('theta_t_displacement_deg_mean')):(column('theta_t_displacement_deg_se')) \
       with yerrorbars ls ours title '5 % of grains moved 0.1 {/:Italic d}, gravity turned', \
     t('lh3_box/compare.tsv') using (column('mu') - 0.003):(column('theta_t_deg')):(column('theta_t_se_deg')) \
       with yerrorbars ls 3 title 'the same, box turned as in the paper'
