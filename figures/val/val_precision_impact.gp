# Validation: error of two-grain impacts against processor time, each integrator over four decades of the time step.
# sweeps: precision
heading = 'Error of impacts of two grains against processor time'
remark = 'unit of the error: impact speed × contact time'
panels = 4
shared = 2
load 'figures/style.gp'
data = t('precision/impact.tsv')
problems = 'hertz_elastic hertz_damped linear_elastic linear_damped'
array words[4] = ['Hertz, elastic', 'Hertz, damped', 'linear, elastic', 'linear, damped']
methods = 'verlet gear5 implicit'
array names[3] = ['velocity Verlet', 'Gear, fifth order', 'implicit, conserving']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(p, col) = strcol('method')[1:strlen(p) + 1] eq p.'/' && column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set ylabel offset powers
set xlabel 'processor time of an impact (s)'
set ylabel 'error of position'
set xrange [1e-6:0.2]
set yrange [1e-12:1]
do for [i = 1:4] {
  p = word(problems, i)
  eval panel(i, sprintf('(%s) %s', word('a b c d', i), words[i]))
  plot for [k = 1:3] data using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints ls k title names[k], \
       data using (front(p, 'seconds')):(front(p, 'error')) with points pt 6 ps 1.2 lw 1.5 lc rgb '#d55e00' title 'Pareto front'
}
