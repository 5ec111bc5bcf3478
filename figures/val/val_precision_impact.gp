# Validation: error of two-grain impacts against processor time, each integrator over four decades of the time step.
# tables: validation_precision_impact.tsv
width = 16.0
height = 13.0
load 'figures/style.gp'
data = t('validation_precision_impact.tsv')
problems = 'hertz_elastic hertz_damped linear_elastic linear_damped'
array words[4] = ['Hertz, elastic', 'Hertz, damped', 'linear, elastic', 'linear, damped']
methods = 'verlet gear5 implicit'
array names[3] = ['velocity Verlet', 'Gear, fifth order', 'implicit, conserving']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(p, col) = strcol('method')[1:strlen(p) + 1] eq p.'/' && column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set xrange [1e-6:0.2]
set yrange [1e-12:1]
set key bottom left Left reverse font ',7.5' samplen 1.5
set multiplot layout 2, 2 margins 0.1, 0.98, 0.09, 0.95 spacing 0.03, 0.08
do for [i = 1:4] {
  p = word(problems, i)
  set title words[i] font ',9' offset 0, -0.6
  set ylabel i % 2 ? 'error of position / (speed × contact time)' : '' font ',9'
  set xlabel i > 2 ? 'processor time of an impact (s)' : '' font ',9'
  if (i % 2) { set format y '10^{%T}' } else { set format y '' }
  if (i > 1) { unset key }
  plot for [k = 1:3] data using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints pt int(word('7 5 9', k)) ps 0.55 lw 0.8 lc int(word('2 3 7', k)) title names[k], \
       data using (front(p, 'seconds')):(front(p, 'error')) with points pt 6 ps 1.2 lc 1 title 'Pareto front'
}
unset multiplot
