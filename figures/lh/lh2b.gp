# Lee & Herrmann 1993, figure 2(b): angle of repose against the width of the box at H/W = 2, with theta_inf + c/W.
# tables: lh2b.tsv lh2b_size.tsv
stats t('lh2b.tsv') using (column('n')) nooutput name 'P'
mus = '0.3 0.2 0.1'
marks = '5 7 9'
size(mu, name) = real(pick('lh2b_size.tsv', 'mu', mu, name))
limits(mu) = sprintf('{/:Italic μ} = %s, limit %.1f ± %.1f', mu, size(mu, 'limit'), size(mu, 'limit_se'))
at(mu, x) = column('mu') == real(mu) ? x : NaN
array limit[3]; array c[3]
do for [i=1:3] { limit[i] = size(word(mus, i), 'limit'); c[i] = size(word(mus, i), 'c') }
set xlabel 'width {/:Italic W} (cm), height {/:Italic H} = 2 {/:Italic W}'
set ylabel 'angle of repose {/:Italic θ}_R (degrees)'
set xrange [1.2:4.3]
set yrange [0:45]
set key top left Left reverse
set label 1 sprintf('filled: method 3, open: method 2; bars: standard error over %d piles; lines: {/:Italic θ}_∞ + {/:Italic c/W}, method 3', P_max) at graph 0.99, 0.05 right font ',6'
plot for [i=1:3] t('lh2b.tsv') using (at(word(mus, i), column('W') + 0.03*(i - 2))):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars pt int(word(marks, i)) ps 0.7 lc i + 1 title limits(word(mus, i)), \
     for [i=1:3] t('lh2b.tsv') using (at(word(mus, i), column('W') + 0.03*(i - 1))):(column('theta_r2_deg_mean')):(column('theta_r2_deg_se')) \
       with yerrorbars pt int(word(marks, i)) - 1 ps 0.6 lw 0.5 lc i + 1 notitle, \
     for [i=1:3] [1.5:4] limit[i] + c[i]/x with lines dt 2 lc i + 1 notitle
