# Lee & Herrmann 1993, figure 2(a): angle of repose against the height of the box.
# sweeps: lh2a
heading = 'Angle of repose against height of the box'
remark = sprintf('bars: standard error over %d piles at most, in (a) smaller than the marks; changes: of a straight line over the whole range of {/:Italic H}', most('lh2a/points.tsv', 'n'))
panels = 2
shared = 3
sample = 0
load 'figures/style.gp'
mus = '0.3 0.2 0.1'
change(mu) = sprintf('{/:Italic μ} = %s, changes by %.1f ± %.1f', mu, real(pick('lh2a/trend.tsv', 'mu', mu, 'change')), real(pick('lh2a/trend.tsv', 'mu', mu, 'change_se')))
at(mu, x) = column('mu') == real(mu) ? x : NaN
set xlabel 'height {/:Italic H} (cm), width {/:Italic W} = 2 cm'
set ylabel '{/:Italic θ}_R (degrees), method 3'
set xrange [1.5:8.5]
set yrange [0:35]
eval panel(1, '(a)')
plot for [i=1:3] t('lh2a/points.tsv') using (at(word(mus, i), column('H') + 0.05*(i - 2))):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars ls i title change(word(mus, i))
eval panel(2, '(b) less that at the smallest {/:Italic H}')
low(mu) = real(system(rows_do('lh2a/points.tsv', '', is('mu', mu).' && (!m || $c["H"] + 0 < m) { m = $c["H"] + 0; low = $c["theta_r3_deg_mean"] } END { print low }')))
array first[3]
do for [i=1:3] { first[i] = low(word(mus, i)) }
set ylabel 'change of {/:Italic θ}_R (degrees)'
set yrange [-6:8]
set xzeroaxis ls guide
plot for [i=1:3] t('lh2a/points.tsv') using (at(word(mus, i), column('H') + 0.05*(i - 2))):(column('theta_r3_deg_mean') - first[i]):(column('theta_r3_deg_se')) \
       with yerrorbars ls i title change(word(mus, i))
