# Processor time and memory of the static solver, linearised piles, against the number of disks; lines are the power
# laws through the largest pile with the exponents in the table's header.
# tables: validation_scaling.tsv
width = 16.0
height = 8.0
load 'figures/style.gp'
scaling = t('validation_scaling.tsv')
of(alpha, what) = column('alpha_deg') == alpha ? column(what) : NaN
power(what, alpha) = note('validation_scaling.tsv', sprintf('%s_exponent_%d', what, alpha))
name(what, alpha) = sprintf('slope of %d°: {/:Italic n}^{ %s}', alpha, power(what, alpha))
largest(what, alpha) = real(system(sprintf("awk -F'\t' '!/^#/ && $1 == %d { y = $%d / $2^%s } END { print y }' ", alpha, what eq 'seconds' ? 3 : 4, power(what, alpha)).path('validation_scaling.tsv')))
set multiplot layout 1, 2
set logscale xy
set format '10^{%T}'
set xlabel 'disks {/:Italic n}'
set xrange [200:1e6]
set key top left font ',8' spacing 1.2
set ylabel 'processor time (s)'
do for [what in 'seconds memory'] {
  if (what eq 'memory') { set ylabel 'peak memory (MB)' }
  a30 = largest(what, 30); a60 = largest(what, 60)
  p30 = real(power(what, 30)); p60 = real(power(what, 60))
  plot scaling using (column('n_disks')):(of(30, what)) with points pt 5 ps 0.7 lc 2 title name(what, 30), \
       scaling using (column('n_disks')):(of(60, what)) with points pt 9 ps 0.9 lc 3 title name(what, 60), \
       [2e4:3e5] a30*x**p30 with lines lc 2 notitle, [2e4:3e5] a60*x**p60 with lines lc 3 dt 2 notitle
}
unset multiplot
