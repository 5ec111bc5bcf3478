# Lee & Herrmann 1993, section 3: angle of repose against normal stiffness, normal damping and shear stiffness.
# sweeps: claims lh_gamma lh_kn lh_kn_wall lh_ks
heading = 'Angle of repose against stiffness and damping'
remark = 'bars: standard error, those of Lee and Herrmann as printed; series shifted sideways; (d) walls 2 × 10^6; band: the shift that the five have in common'
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
# the five printed settings, and the shift that they have in common
mine(name, key, value, c) = real(pick(name, key, value, c))
array ours_less[5]; array error[5]
settings = '1e4 1e5 50 100 500'
ids = 'lh-kn-1e4 lh-kn-1e5 lh-gamma-50 lh-gamma-100 lh-theta'
weight = 0; shift = 0
do for [i=1:5] {
    name = i < 3 ? 'lh_kn_wall/points.tsv' : 'lh_gamma/points.tsv'
    key_of = i < 3 ? 'k_n' : 'gamma_n'
    id = word(ids, i)
    ours_less[i] = mine(name, key_of, word(settings, i), y) - published(id, 'published')
    error[i] = sqrt(mine(name, key_of, word(settings, i), se)**2 + published(id, 'published_se')**2)
    weight = weight + 1/error[i]**2
    shift = shift + ours_less[i]/error[i]**2
}
shift = shift/weight
eval panel(4, '(d) ours less the printed angle')
unset logscale x
set xlabel ' '
set ylabel 'difference (degrees)'
set xrange [0.5:5.5]
set yrange [-3:4]
set xtics ('10^4' 1, '10^5' 2, '50' 3, '100' 4, '500' 5)
set label 1 '{/:Italic k}_n' at graph 0.2, graph -0.2 center
set label 2 '{/:Italic γ}_n' at graph 0.7, graph -0.2 center
plot '+' using (0.5 + 5*$0):(shift - 1/sqrt(weight)):(shift + 1/sqrt(weight)) every ::0::1 with filledcurves fc rgb '#dddddd' notitle, \
     '+' using ($0 + 1):(ours_less[int($0) + 1]):(error[int($0) + 1]) every ::0::4 with yerrorbars ls 1 notitle
