# Lee & Herrmann 1993, figure 7(b): measured theta_T against (4) at the measured theta_R, in its four forms.
# tables: lh3_compare.tsv
stats t('lh3_compare.tsv') using (column('n')) nooutput name 'P'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:14]
set key top left Left reverse
set label 1 sprintf('bars: standard error over %d piles (theory: bootstrap of {/:Italic θ}_R); series shifted', P_max) at graph 0.98, 0.05 right font ',8'
c(name) = column('theta_t_'.name.'_deg')
e(name) = column('theta_t_'.name.'_se_deg')
plot t('lh3_compare.tsv') using (column('mu')):(column('theta_t_deg')):(column('theta_t_se_deg')) \
       with yerrorbars pt 7 ps 0.8 lc 2 title 'measured, by displacement', \
     '' using (column('mu') + 0.002):(c('printed')):(e('printed')) with yerrorlines pt 4 ps 0.6 lc 7 title '(4) as printed', \
     '' using (column('mu') + 0.004):(c('sine')):(e('sine')) with yerrorlines pt 6 ps 0.6 lc 3 title '(4) with sines', \
     '' using (column('mu') - 0.002):(c('balanced')):(e('balanced')) with yerrorlines pt 8 ps 0.7 lc 4 title 'forces balanced, rays fixed to gravity', \
     '' using (column('mu') - 0.004):(c('lattice')):(e('lattice')) with yerrorlines pt 12 ps 0.7 lc 8 title 'forces balanced, rays fixed to the lattice'
