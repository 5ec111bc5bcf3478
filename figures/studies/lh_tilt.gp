# Onset of motion under tilt against the tilting rate; gravity or the box is rotated.
# sweeps: lh_tilt lh_tilt_static
heading = 'Onset of motion against the rate of tilt'
remark = 'bars: standard error over piles; lines without points: 0.1° at a time, each to rest'
panels = 2
shared = 3
sample = 0
load 'figures/style.gp'
of(mu, tilt, x) = column('mu') == real(mu) && strcol('tilt') eq tilt ? x : NaN
rest(mu, tilt) = real(system(rows_do('lh_tilt_static/points.tsv', '', is('mu', mu).' && '.is('tilt', tilt).' { print $c["theta_t_static_deg_mean"] }')))
tilt(j) = word('gravity box', j)
by(i) = word('displacement energy', i)
rates = t('lh_tilt/points.tsv')
set logscale x
set format x '10^{%T}'
set xrange [2e-5:1.6e-3]
set xlabel 'rotation per step (degrees)'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set yrange [0:8]
do for [k=1:2] {
    mu = word('0.1 0.2', k)
    eval panel(k, sprintf('(%s) {/:Italic μ} = %s', word('a b', k), mu))
    gravity = rest(mu, 'gravity')
    box = rest(mu, 'box')
    plot gravity with lines ls 1 dt 3 title 'gravity rotated, static', \
         box with lines ls 2 dt 3 title 'box rotated, static', \
         for [j=1:2] for [i=1:2] rates using (of(mu, tilt(j), column('tilt_rate_deg')*1.06**(i - 1))):(column('theta_t_'.by(i).'_deg_mean')):(column('theta_t_'.by(i).'_deg_se')) \
           with yerrorbars ls j pt 10 - 2*j - i title tilt(j).' rotated, by '.by(i)
}
