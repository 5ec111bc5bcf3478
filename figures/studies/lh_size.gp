# Angle of repose against size by three methods, three frictions. `make studies`.
# sweeps: lh_size lh_size_large lh_size_mid
heading = 'Angle of repose against the size of the box'
remark = sprintf('bars: standard error, %d piles a point up to {/:Italic W} = 4, %d at 6 and 8, %d beyond', \
                 most('lh_size/points.tsv', 'n'), most('lh_size_mid/points.tsv', 'n'), most('lh_size_large/points.tsv', 'n'))
panels = 3
legend = 3
sample = 0
load 'figures/style.gp'
mus = '0.3 0.2 0.1'
runs = 'lh_size/points.tsv lh_size_mid/points.tsv lh_size_large/points.tsv'
at(mu, x) = column('mu') == real(mu) ? x : NaN
set logscale x 2
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel '{/:Italic θ}_R (degrees)'
set xrange [1.7:19]
set yrange [0:40]
do for [m=1:3] {
  eval panel(m, 'method '.m)
  mean = sprintf('theta_r%d_deg_mean', m)
  se = sprintf('theta_r%d_deg_se', m)
  plot for [k=1:3] for [i=1:3] t(word(runs, k)) using (at(word(mus, i), column('W')*(1 + 0.02*(i - 2)))):(column(mean)):(column(se)) \
         with yerrorbars ls i title k == 1 ? '{/:Italic μ} = '.word(mus, i) : ''
}
