# What was found in the two papers' piles, in four panels: the picture of the report's first page.
# sweeps: claims lh3 lh3_box lh_floor_upper li20_history li20_point
heading = 'What was found'
remark = 'bars: standard errors; that of the paper as printed'
panels = 4
legend = 4
load 'figures/style.gp'
fit = 'lh3/fit_theta_r.tsv'
slope = real(pick(fit, 'line', 'free', 'slope'))
start = real(pick(fit, 'line', 'free', 'intercept'))
theta = published('lh-theta', 'published')
se = published('lh-theta', 'published_se')
eval panel(1, '(a) angle of repose')
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel '{/:Italic θ}_R (degrees)'
set xrange [-0.01:0.32]
set yrange [0:30]
plot within(0.05, 0.2, x, start + slope*x) with lines ls theory title 'straight line, 0.05 ≤ {/:Italic μ} ≤ 0.2', \
     t('lh3/points.tsv') using (column('mu')):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) with yerrorbars ls ours title 'measured', \
     '+' using (0.2):(theta):(se) every ::0::0 with yerrorbars ls paper title 'Lee and Herrmann'
eval panel(2, '(b) friction of the floor, 0.1 to 0.4')
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel 'change of the slope (degrees)'
set logscale x 2
set xrange [1.7:19]
set yrange [-8:16]
set xzeroaxis ls guide
plot t('lh_floor_upper/trend.tsv') using (column('W')):(column('change')):(column('change_se')) with yerrorbars ls 1 title 'whole surface', \
     t('lh_floor_upper/trend_top.tsv') using (column('W')*1.05):(column('change')):(column('change_se')) with yerrorbars ls 2 title 'upper half: the paper expects 0'
unset logscale x
unset xzeroaxis
eval panel(3, '(c) tilting angle')
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel '{/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:12]
plot t('lh3/compare.tsv') using (column('mu')):(column('theta_t_lattice_deg')) with lines ls 11 title '(4) with balanced forces', \
     t('lh3/compare.tsv') using (column('mu')):(column('theta_t_deg')):(column('theta_t_se_deg')) with yerrorbars ls ours title 'gravity turned, by displacement', \
     t('lh3_box/compare.tsv') using (column('mu')):(column('theta_t_deg')):(column('theta_t_se_deg')) with yerrorbars ls 3 title 'box turned as in the paper, by displacement', \
     t('lh3_box/points.tsv') using (column('mu')):(column('theta_t_energy_deg_mean')):(column('theta_t_energy_deg_se')) with yerrorbars ls 4 title 'box turned, by kinetic energy'
eval panel(4, '(d) pressure under dropped piles')
set xlabel 'distance from the centroid / {/:Italic B}'
set ylabel '{/:Italic N} over its mean'
set xrange [0:0.25]
set yrange [1.1:1.45]
plot t('li20_point/profile.tsv') using (column('distance')):(column('N')):(column('N_se')) with yerrorlines ls 1 title "the paper's contacts", \
     t('li20_point/profile.tsv') using (column('distance')):(column('rays')) with lines ls 10 title 'rays under the outlines of these', \
     t('li20_history/rough_profile.tsv') using (column('distance')):(column('N')):(column('N_se')) with yerrorlines ls 2 title 'rough base, point source', \
     t('li20_history/rough_wide_profile.tsv') using (column('distance')):(column('N')):(column('N_se')) with yerrorlines ls 3 title 'rough base, wide source'
