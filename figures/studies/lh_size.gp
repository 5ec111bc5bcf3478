# Angle of repose against size by three methods, three frictions, with limit + c/W^p through the means. `make studies`.
# sweeps: lh_size lh_size_large lh_size_mid
heading = 'Angle of repose against the size of the box'
remark = sprintf('bars: standard error, %d piles a point up to {/:Italic W} = 4, %d at 6 and 8, %d beyond; lines: limit + {/:Italic c/W^p}, none where a logarithm fits best; limits: 95 %% intervals', \
                 most('lh_size/points.tsv', 'n'), most('lh_size_mid/points.tsv', 'n'), most('lh_size_large/points.tsv', 'n'))
panels = 3
legend = 3
load 'figures/style.gp'
mus = '0.3 0.2 0.1'
runs = 'lh_size/points.tsv lh_size_mid/points.tsv lh_size_large/points.tsv'
fit(m, mu, name) = pick('lh_size_large/limit_r'.m.'.tsv', 'mu', mu, name)
end(s) = strstrt(s, 'inf') ? (s[1:1] eq '-' ? '–∞' : '∞') : sprintf('%.1f', real(s))
limits(m, mu) = sprintf('{/:Italic μ} = %s, limit %s to %s', mu, end(fit(m, mu, 'limit_lo')), end(fit(m, mu, 'limit_hi')))
fitted(m, mu) = fit(m, mu, 'status') ne 'no_result' && real(fit(m, mu, 'exponent')) > 0
at(mu, x) = column('mu') == real(mu) ? x : NaN
array limit[3]; array c[3]; array p[3]
set logscale x 2
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel '{/:Italic θ}_R (degrees)'
set xrange [1.7:19]
set yrange [0:40]
do for [m=1:3] {
  do for [i=1:3] {
    limit[i] = NaN; c[i] = 0; p[i] = 1
    if (fitted(m, word(mus, i))) {
      limit[i] = real(fit(m, word(mus, i), 'limit')); c[i] = real(fit(m, word(mus, i), 'c')); p[i] = real(fit(m, word(mus, i), 'exponent'))
    }
  }
  eval panel(m, 'method '.m)
  mean = sprintf('theta_r%d_deg_mean', m)
  se = sprintf('theta_r%d_deg_se', m)
  plot for [i=1:3] within(2, 16, x, limit[i] + c[i]/x**p[i]) with lines ls theory notitle, \
       for [k=1:3] for [i=1:3] t(word(runs, k)) using (at(word(mus, i), column('W')*(1 + 0.02*(i - 2)))):(column(mean)):(column(se)) \
         with yerrorbars ls i title k == 1 ? limits(m, word(mus, i)) : ''
}
