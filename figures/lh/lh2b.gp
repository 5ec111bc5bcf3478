# Lee & Herrmann 1993, figure 2(b): angle of repose against the width of the box at H/W = 2, with theta_inf + c/W.
# sweeps: lh2b
heading = 'Angle of repose against the width of the box'
remark = sprintf('filled: method 3, open: method 2; bars: standard error over %d piles, in (a) smaller than the marks; lines: {/:Italic θ}_∞ + {/:Italic c/W}, method 3', most('lh2b/points.tsv', 'n'))
panels = 2
shared = 3
sample = 0
load 'figures/style.gp'
mus = '0.3 0.2 0.1'
size(mu, name) = real(pick('lh2b/size.tsv', 'mu', mu, name))
limits(mu) = sprintf('{/:Italic μ} = %s, limit %.1f ± %.1f', mu, size(mu, 'limit'), size(mu, 'limit_se'))
at(mu, x) = column('mu') == real(mu) ? x : NaN
widest(mu) = real(system(rows_do('lh2b/points.tsv', '', is('mu', mu).' && '.is('W', '4').' { print $c["theta_r3_deg_mean"] }')))
array limit[3]; array c[3]; array end[3]
do for [i=1:3] { limit[i] = size(word(mus, i), 'limit'); c[i] = size(word(mus, i), 'c'); end[i] = widest(word(mus, i)) }
set xlabel 'width {/:Italic W} (cm), height {/:Italic H} = 2 {/:Italic W}'
set xrange [1.2:4.3]
eval panel(1, '(a) both methods')
set ylabel '{/:Italic θ}_R (degrees)'
set yrange [0:35]
plot for [i=1:3] within(1.5, 4, x, limit[i] + c[i]/x) with lines ls theory notitle, \
     for [i=1:3] t('lh2b/points.tsv') using (at(word(mus, i), column('W') + 0.03*(i - 1))):(column('theta_r2_deg_mean')):(column('theta_r2_deg_se')) \
       with yerrorbars ls i pt int(word('6 4 8', i)) notitle, \
     for [i=1:3] t('lh2b/points.tsv') using (at(word(mus, i), column('W') + 0.03*(i - 2))):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars ls i title limits(word(mus, i))
eval panel(2, '(b) method 3, less its value at 4 cm')
set ylabel 'change (degrees)'
set yrange [-1.2:2.2]
plot for [i=1:3] within(1.5, 4, x, limit[i] + c[i]/x - end[i]) with lines ls 10 + i notitle, \
     for [i=1:3] t('lh2b/points.tsv') using (at(word(mus, i), column('W') + 0.03*(i - 2))):(column('theta_r3_deg_mean') - end[i]):(column('theta_r3_deg_se')) \
       with yerrorbars ls i notitle
