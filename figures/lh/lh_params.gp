# Lee & Herrmann 1993, section 3: angle of repose against normal stiffness, normal damping and shear stiffness.
# tables: lh_gamma.tsv lh_kn.tsv lh_kn_restitution.tsv lh_kn_wall.tsv lh_ks.tsv published.tsv
names = 'lh_kn lh_kn_wall lh_kn_restitution lh_gamma lh_ks'
array piles[5]
do for [i=1:5] { stats t(word(names, i).'.tsv') using (column('n')) nooutput name 'P'; piles[i] = P_max }
with_piles(text, i) = sprintf('%s, %d piles', text, piles[i])
set multiplot layout 1,3 margins 0.085,0.99,0.15,0.9 spacing 0.02
set yrange [0:32]
set logscale x
set format x '10^{%T}'
set key top left Left reverse font ',6.5' samplen 1 spacing 1.1
set label 2 'bars: standard error, those of Lee and Herrmann as printed; series shifted' at screen 0.5, 0.95 center font ',8'
set ylabel 'angle of repose {/:Italic θ}_R (degrees), method 3' font ',9' offset 0.8,0
set xlabel '{/:Italic k}_n (dyn/cm^{1.5})'
set xrange [4e3:4e6]
paper(x, id) = sprintf("%s\t%.17g\t%.17g", x, published(id, 'published'), published(id, 'published_se'))
set print $kn
print "k_n\ttheta\tse"
print paper('1e4', 'lh-kn-1e4')
print paper('1e5', 'lh-kn-1e5')
print paper('1e6', 'lh-theta')
set print $gamma
print "gamma_n\ttheta\tse"
print paper('50', 'lh-gamma-50')
print paper('100', 'lh-gamma-100')
print paper('500', 'lh-theta')
set print
y = 'theta_r3_deg_mean'
se = 'theta_r3_deg_se'
plot t('lh_kn.tsv') using (column('k_n')):(column(y)):(column(se)) with yerrorbars pt 7 ps 0.7 lc 2 title with_piles('walls 2 {/:Italic k}_n', 1), \
     t('lh_kn_wall.tsv') using (column('k_n')*1.15):(column(y)):(column(se)) with yerrorbars pt 5 ps 0.7 lc 3 title with_piles('walls 2 × 10^6', 2), \
     t('lh_kn_restitution.tsv') using (column('k_n')*1.32):(column(y)):(column(se)) with yerrorbars pt 13 ps 0.7 lc 4 title with_piles('walls 2 {/:Italic k}_n, {/:Italic γ}_n ∝ {/:Italic k}_n^{0.4}', 3), \
     $kn using ($1/1.15):2:3 with yerrorbars pt 8 ps 0.8 lc 1 title 'Lee and Herrmann'
unset label 2
unset ylabel
set format y ''
set format x '%g'
set xlabel '{/:Italic γ}_n (1/s)'
set xrange [30:800]
set xtics (50, 100, 200, 500)
plot t('lh_gamma.tsv') using (column('gamma_n')):(column(y)):(column(se)) with yerrorbars pt 7 ps 0.7 lc 2 title with_piles('Repose', 4), \
     $gamma using ($1/1.06):2:3 with yerrorbars pt 8 ps 0.8 lc 1 title 'Lee and Herrmann'
set format x '10^{%T}'
set xtics autofreq
set xlabel '{/:Italic k}_s (dyn/cm)'
set xrange [4e2:2.5e5]
plot t('lh_ks.tsv') using (column('k_s')):(column(y)):(column(se)) with yerrorbars pt 7 ps 0.7 lc 2 title with_piles('Repose', 5)
unset multiplot
