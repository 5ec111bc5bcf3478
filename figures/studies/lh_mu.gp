# Angle of repose of grains of large friction by three methods: it rises to a maximum and falls again. `make studies`.
# sweeps: lh_mu
heading = 'Angle of repose of grains of large friction'
remark = sprintf('bars: standard error over the piles at rest, of %d a point; {/:Italic W} = {/:Italic H} = 4 cm', most('lh_mu/points.tsv', 'n'))
legend = 3
sample = 0
load 'figures/style.gp'
set logscale x
set xlabel 'friction {/:Italic μ}'
set ylabel '{/:Italic θ}_R (degrees)'
set xrange [0.27:2.2]
set yrange [0:40]
set xtics (0.3, 0.4, 0.5, 0.6, 0.8, 1, 1.4, 2)
plot for [m=1:3] t('lh_mu/points.tsv') using (column('mu')*(1 + 0.01*(m - 2))):(column(sprintf('theta_r%d_deg_mean', m))):(column(sprintf('theta_r%d_deg_se', m))) \
       with yerrorbars ls m title sprintf('method %d', m)
