# Processor time and memory of the static solver, linearised piles, against the number of disks; lines are the power
# laws through the largest pile with the exponents in the table's header.
# sweeps: scaling
heading = 'Processor time and memory of the static solver'
panels = 2
legend = 2
load 'figures/style.gp'
scaling = t('scaling/scaling.tsv')
of(alpha, what) = column('alpha_deg') == alpha ? column(what) : NaN
power(what, alpha) = note('scaling/scaling.tsv', sprintf('%s_exponent_%d', what, alpha))
name(what, alpha) = sprintf('slope of %d°: {/:Italic n}^{ %s}', alpha, power(what, alpha))
largest(what, alpha) = real(system(sprintf("awk -F'\t' '!/^#/ && $1 == %d { y = $%d / $2^%s } END { print y }' ", alpha, what eq 'seconds' ? 3 : 4, power(what, alpha)).path('scaling/scaling.tsv')))
set logscale xy
set format '10^{%T}'
set ylabel offset powers
set xlabel 'disks {/:Italic n}'
set xrange [200:1e6]
do for [k=1:2] {
  what = word('seconds memory', k)
  eval panel(k, word('"(a) processor time" "(b) memory"', k))
  set ylabel word('"processor time (s)" "peak memory (MB)"', k)
  a30 = largest(what, 30); a60 = largest(what, 60)
  p30 = real(power(what, 30)); p60 = real(power(what, 60))
  plot within(2e4, 3e5, x, a30*x**p30) with lines ls 11 notitle, within(2e4, 3e5, x, a60*x**p60) with lines ls 12 notitle, \
       scaling using (column('n_disks')):(of(30, what)) with points ls 1 title name(what, 30), \
       scaling using (column('n_disks')):(of(60, what)) with points ls 3 title name(what, 60)
}
