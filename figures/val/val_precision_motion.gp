# Validation: error against processor time of a damped column and of 100 settling grains, each integrator over
# decades of the time step.
# sweeps: precision
heading = 'Error of motions of many grains against processor time'
panels = 2
shared = 2
load 'figures/style.gp'
array data[2] = [t('precision/column.tsv'), t('precision/settling.tsv')]
array words[2] = ['column of 10, weight doubled, 20 ms', '100 grains that settle, 30 ms']
array units[2] = ['error of positions / sink of the top', 'error of positions / diameter']
problems = 'column settling'
methods = 'verlet gear5 implicit'
array names[3] = ['velocity Verlet', 'Gear, fifth order', 'implicit, conserving']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(col) = column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set ylabel offset powers
set xlabel 'processor time (s)'
do for [i = 1:2] {
  p = word(problems, i)
  eval panel(i, sprintf('(%s) %s', word('a b c d', i), words[i]))
  set ylabel units[i]
  plot for [k = 1:3] data[i] using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints ls k title names[k], \
       data[i] using (front('seconds')):(front('error')) with points pt 6 ps 1.2 lw 1.5 lc rgb '#d55e00' title 'Pareto front'
}
