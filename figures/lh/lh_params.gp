# Lee & Herrmann 1993, section 3: angle of repose against normal stiffness, normal damping and shear stiffness.
# sweeps: claims lh_gamma lh_kn lh_kn_wall lh_ks
heading = 'Angle of repose against stiffness and damping'
remark = 'bars: standard error, those of Lee and Herrmann as printed; series shifted sideways'
panels = 3
shared = 2
load 'figures/style.gp'
with_piles(text, name) = sprintf('%s, %d piles', text, most(name, 'n'))
set print $kn
print "k_n\ttheta\tse\n", printed('1e4', 'lh-kn-1e4'), "\n", printed('1e5', 'lh-kn-1e5'), "\n", printed('1e6', 'lh-theta')
set print $gamma
print "gamma_n\ttheta\tse\n", printed('50', 'lh-gamma-50'), "\n", printed('100', 'lh-gamma-100'), "\n", printed('500', 'lh-theta')
set print
y = 'theta_r3_deg_mean'
se = 'theta_r3_deg_se'
set ylabel '{/:Italic θ}_R (degrees), method 3'
set yrange [13:22]
set logscale x
set format x '10^{%T}'
eval panel(1, '(a) normal stiffness')
set xlabel '{/:Italic k}_n (dyn/cm^{1.5})'
set xrange [4e3:4e6]
plot t('lh_kn/points.tsv') using (column('k_n')):(column(y)):(column(se)) with yerrorbars ls 1 title with_piles('walls 2 {/:Italic k}_n', 'lh_kn/points.tsv'), \
     t('lh_kn_wall/points.tsv') using (column('k_n')*1.15):(column(y)):(column(se)) with yerrorbars ls 2 title with_piles('walls 2 × 10^6', 'lh_kn_wall/points.tsv'), \
     $kn using ($1/1.15):2:3 with yerrorbars ls paper title 'Lee and Herrmann'
eval panel(2, with_piles('(b) normal damping', 'lh_gamma/points.tsv'))
set format x '%g'
set xlabel '{/:Italic γ}_n (1/s)'
set xrange [30:800]
set xtics (50, 100, 200, 500)
plot t('lh_gamma/points.tsv') using (column('gamma_n')):(column(y)):(column(se)) with yerrorbars ls 1 notitle, \
     $gamma using ($1/1.06):2:3 with yerrorbars ls paper notitle
eval panel(3, with_piles('(c) shear stiffness', 'lh_ks/points.tsv'))
set format x '10^{%T}'
set xtics autofreq
set xlabel '{/:Italic k}_s (dyn/cm)'
set xrange [4e2:2.5e5]
plot t('lh_ks/points.tsv') using (column('k_s')):(column(y)):(column(se)) with yerrorbars ls 1 notitle
