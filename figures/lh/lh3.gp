# Lee & Herrmann 1993, figure 3: angle of repose against friction.
# sweeps: claims lh3 lh3_total
heading = 'Angle of repose against friction'
remark = sprintf('bars: standard error over %d piles, Lee and Herrmann as printed; series shifted sideways', most('lh3/points.tsv', 'n'))
panels = 2
shared = 5
load 'figures/style.gp'
fit = 'lh3/fit_theta_r.tsv'
slope = real(pick(fit, 'line', 'free', 'slope'))
start = real(pick(fit, 'line', 'free', 'intercept'))
theta = published('lh-theta', 'published')
se = published('lh-theta', 'published_se')
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel '{/:Italic θ}_R (degrees), method 3'
set xrange [-0.01:0.32]
set yrange [0:30]
eval panel(1, '(a)')
straight(x) = start + slope*x
plot within(0.05, 0.2, x, straight(x)) with lines ls theory title 'straight line, 0.05 ≤ {/:Italic μ} ≤ 0.2', \
     straight(x) with lines ls guide title 'the same, beyond', \
     t('lh3_total/points.tsv') using (column('mu') + 0.003):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars ls 2 title '(2b) as printed, '.note('lh3_total/points.tsv', 'relax_steps').' steps after opening', \
     t('lh3/points.tsv') using (column('mu')):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars ls ours title '(2b) truncated at the Coulomb limit, at rest', \
     '+' using (0.207):(theta):(se) every ::0::0 with yerrorbars ls paper title 'Lee and Herrmann'
eval panel(2, '(b) less the straight line')
set ylabel 'difference (degrees)'
set yrange [-3:3]
set xzeroaxis ls guide
plot t('lh3_total/points.tsv') using (column('mu') + 0.003):(column('theta_r3_deg_mean') - straight(column('mu'))):(column('theta_r3_deg_se')) with yerrorbars ls 2 notitle, \
     t('lh3/points.tsv') using (column('mu')):(column('theta_r3_deg_mean') - straight(column('mu'))):(column('theta_r3_deg_se')) with yerrorbars ls ours notitle, \
     '+' using (0.207):(theta - straight(0.2)):(se) every ::0::0 with yerrorbars ls paper notitle
