# Lee & Herrmann 1993, section 3: angle of repose against normal stiffness, normal damping and shear stiffness.
# sweeps: claims lh_drop lh_gamma lh_kn lh_kn_wall lh_ks lh_ramp
heading = 'Angle of repose against stiffness and damping'
remark = 'bars: standard errors, theirs as printed; series shifted sideways; in (a) and (b) gravity grows as the box is filled; (d) walls 2 × 10^6'
panels = 4
shared = 2
sample = 0
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
set yrange [12:22]
set logscale x
set format x '10^{%T}'
eval panel(1, '(a) normal stiffness')
set xlabel '{/:Italic k}_n (dyn/cm^{1.5})'
set xrange [4e3:4e6]
plot t('lh_kn/points.tsv') using (column('k_n')):(column(y)):(column(se)) with yerrorbars ls 1 title with_piles('walls 2 {/:Italic k}_n', 'lh_kn/points.tsv'), \
     t('lh_kn_wall/points.tsv') using (column('k_n')*1.15):(column(y)):(column(se)) with yerrorbars ls 2 title with_piles('walls 2 × 10^6', 'lh_kn_wall/points.tsv'), \
     $kn using ($1/1.15):2:3 with yerrorbars ls paper title 'Lee and Herrmann', \
     keyentry with points ls 3 title with_piles('(d) gravity grows', 'lh_ramp/points.tsv'), \
     keyentry with points ls 4 title with_piles('(d) grains fall', 'lh_drop/points.tsv')
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
# the five printed settings, on piles that are all filled in one way
array angle[5]; array error[5]
ids = 'lh-kn-1e4 lh-kn-1e5 lh-gamma-50 lh-gamma-100 lh-theta'
do for [i=1:5] { angle[i] = published(word(ids, i), 'published'); error[i] = published(word(ids, i), 'published_se') }
setting(k, g) = k < 2e4 ? 1 : k < 2e5 ? 2 : g < 70 ? 3 : g < 200 ? 4 : 5
this(i) = setting(column('k_n'), column('gamma_n'))
chosen(i) = column('density') == 1 && stringcolumn('slip') eq 'truncated' && column('n') >= 90 ? 1 : NaN
eval panel(4, '(d) ours less the printed angle')
unset logscale x
set xlabel ' '
set ylabel 'difference (degrees)'
set xrange [0.5:5.5]
set yrange [-3:5]
set xtics ('10^4' 1, '10^5' 2, '50' 3, '100' 4, '500' 5)
set label 1 '{/:Italic k}_n' at graph 0.2, graph -0.2 center
set label 2 '{/:Italic γ}_n' at graph 0.7, graph -0.2 center
plot 0 with lines ls guide notitle, \
     t('lh_ramp/points.tsv') using (this(0) - 0.08*chosen(0)):(column(y) - angle[this(0)]):(sqrt(column(se)**2 + error[this(0)]**2)) with yerrorbars ls 3 notitle, \
     t('lh_drop/points.tsv') using (this(0) + 0.08*chosen(0)):(column(y) - angle[this(0)]):(sqrt(column(se)**2 + error[this(0)]**2)) with yerrorbars ls 4 notitle
