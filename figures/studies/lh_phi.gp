# Beyond Lee & Herrmann 1993: measured theta_R + theta_T against (3) and theta_T against (4), with rays at 60 degrees
# and at the inclination phi of best fit over all mu, with half its 95 % interval.
# tables: lh3_phi.tsv
width = 18.0
height = 8.0
load 'figures/style.gp'
table = t('lh3_phi.tsv')
# the rows of one equation, for all mu together or for each
all(a) = table.' | awk -F"\t" ''NR == 1 || ($NF == "'.a.'" && $1 == "nan")'''
each(a) = table.' | awk -F"\t" ''NR == 1 || ($NF == "'.a.'" && $1 != "nan")'''
c(name) = column(name)
do for [a in 'marginal balanced lattice'] {
  stats all(a) using (c('phi_deg')) nooutput name a
  stats all(a) using (0.5*(c('phi_hi_deg') - c('phi_lo_deg'))) nooutput name a.'_half'
  stats all(a) using (c('p_value')) nooutput name a.'_p'
}
fit(name, phi, half, p) = sprintf('%s, {/:Italic φ} = %.1f° ± %.1f°, p = %.2g', name, phi, half, p)
set multiplot layout 1, 2
set xlabel 'friction coefficient {/:Italic μ}'
set xrange [0:0.32]
set key top left Left reverse
set ylabel '{/:Italic θ}_R + {/:Italic θ}_T (degrees)'
set yrange [0:58]
plot each('marginal') using (c('mu')):(c('measured_deg')):(c('measured_se_deg')) with yerrorbars pt 7 ps 0.8 lc 2 title 'measured', \
     '' using (c('mu')):(c('sixty_deg')) with lines lc 8 dt 2 title '(3), {/:Italic φ} = 60°', \
     '' using (c('mu')):(c('fitted_deg')) with lines lc 8 title fit('(3)', marginal_mean, marginal_half_mean, marginal_p_mean)
set ylabel '{/:Italic θ}_T (degrees)'
set yrange [0:14]
plot each('balanced') using (c('mu')):(c('measured_deg')):(c('measured_se_deg')) with yerrorbars pt 7 ps 0.8 lc 2 title 'measured, by displacement', \
     '' using (c('mu')):(c('sixty_deg')) with linespoints pt 8 ps 0.6 lc 4 dt 2 title '(4) balanced, 60°', \
     '' using (c('mu')):(c('fitted_deg')) with linespoints pt 8 ps 0.6 lc 4 title fit('(4) balanced', balanced_mean, balanced_half_mean, balanced_p_mean), \
     each('lattice') using (c('mu')):(c('sixty_deg')) with linespoints pt 12 ps 0.6 lc 3 dt 2 title '(4) lattice, 60°', \
     '' using (c('mu')):(c('fitted_deg')) with linespoints pt 12 ps 0.6 lc 3 title fit('(4) lattice', lattice_mean, lattice_half_mean, lattice_p_mean)
unset multiplot
