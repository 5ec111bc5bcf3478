# Beyond Lee & Herrmann 1993: measured theta_R + theta_T against (3) and theta_T against (4), with rays at 60 degrees
# and at the inclination phi of best fit over all mu, with half its 95 % interval.
# tables: lh3_phi.tsv
heading = 'Angles against rays at 60° and at the inclination of best fit'
panels = 2
legend = 5
load 'figures/style.gp'
# the rows of one equation, for all mu together or for each
all(a, col) = real(system(rows_do('lh3_phi.tsv', '', '$NF == "'.a.'" && $1 == "nan" { print $c["'.col.'"] }')))
each(a) = '< '.rows_do('lh3_phi.tsv', 'print; ', '$NF == "'.a.'" && $1 != "nan"')
c(name) = column(name)
fit(name, a) = sprintf('%s, {/:Italic φ} = %.1f° ± %.1f°, p = %.2g', name, all(a, 'phi_deg'), 0.5*(all(a, 'phi_hi_deg') - all(a, 'phi_lo_deg')), all(a, 'p_value'))
set xlabel 'friction coefficient {/:Italic μ}'
set xrange [0:0.32]
eval panel(1, '(a) equation (3)')
set ylabel '{/:Italic θ}_R + {/:Italic θ}_T (degrees)'
set yrange [0:50]
plot each('marginal') using (c('mu')):(c('sixty_deg')) with lines ls 12 title '(3), {/:Italic φ} = 60°', \
     '' using (c('mu')):(c('fitted_deg')) with lines ls 11 title fit('(3)', 'marginal'), \
     '' using (c('mu')):(c('measured_deg')):(c('measured_se_deg')) with yerrorbars ls ours title 'measured'
eval panel(2, '(b) equation (4)')
set ylabel '{/:Italic θ}_T (degrees)'
set yrange [0:10]
plot for [k=1:2] each(word('balanced lattice', k)) using (c('mu')):(c('sixty_deg')) with linespoints ls 11 + k dt 2 title '(4) '.word('balanced lattice', k).', 60°', \
     for [k=1:2] each(word('balanced lattice', k)) using (c('mu')):(c('fitted_deg')) with linespoints ls 11 + k dt 1 title fit('(4) '.word('balanced lattice', k), word('balanced lattice', k)), \
     each('balanced') using (c('mu')):(c('measured_deg')):(c('measured_se_deg')) with yerrorbars ls ours title 'measured, by displacement'
