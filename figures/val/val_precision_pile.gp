# Validation: largest error of a force under static piles against processor time: damped motion to rest, and the
# static solver.
# sweeps: precision
heading = 'Error of the forces under static piles against processor time'
panels = 2
shared = 2
load 'figures/style.gp'
data = t('precision/pile.tsv')
problems = '1035 5490'
array words[2] = ['1035 disks, slopes of 60°', '5490 disks, slopes of 30°']
methods = 'verlet implicit newton'
array names[3] = ['Verlet, {/:Italic ω} d{/:Italic t} = 0.2', 'implicit, {/:Italic ω} d{/:Italic t} = 1', 'static solver']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(p, col) = strcol('method')[1:strlen(p) + 1] eq p.'/' && column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set ylabel offset powers
set xlabel 'processor time (s)'
set ylabel 'largest error / {/:Italic m g}'
set xrange [2e-3:6e1]
set yrange [1e-14:1e3]
set ytics 1e3
do for [i = 1:2] {
  p = word(problems, i)
  eval panel(i, sprintf('(%s) %s', word('a b c d', i), words[i]))
  plot for [k = 1:3] data using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints ls k title names[k], \
       data using (front(p, 'seconds')):(front(p, 'error')) with points pt 6 ps 1.2 lw 1.5 lc rgb '#d55e00' title 'Pareto front'
}
