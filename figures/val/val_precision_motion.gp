# Validation: error against processor time of a damped column and of 100 settling grains, each integrator over
# decades of the time step.
# tables: validation_precision_column.tsv validation_precision_settling.tsv
width = 16.0
height = 8.0
load 'figures/style.gp'
array data[2] = [t('validation_precision_column.tsv'), t('validation_precision_settling.tsv')]
array words[2] = ['column of 10 whose weight doubles, after 20 ms', '100 grains that settle, after 30 ms']
array units[2] = ['error of places / sink of the top', 'error of places / diameter']
problems = 'column settling'
methods = 'verlet gear5 implicit'
array names[3] = ['velocity Verlet', 'Gear, fifth order', 'implicit, conserving']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(col) = column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set xlabel 'processor time (s)'
set key bottom left Left reverse font ',7.5' samplen 1.5
set multiplot layout 1, 2 margins 0.1, 0.98, 0.14, 0.92 spacing 0.11, 0
do for [i = 1:2] {
  p = word(problems, i)
  set title words[i] font ',9' offset 0, -0.6
  set ylabel units[i] offset 1, 0
  if (i > 1) { unset key }
  plot for [k = 1:3] data[i] using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints pt int(word('7 5 9', k)) ps 0.55 lw 0.8 lc int(word('2 3 7', k)) title names[k], \
       data[i] using (front('seconds')):(front('error')) with points pt 6 ps 1.2 lc 1 title 'Pareto front'
}
unset multiplot
