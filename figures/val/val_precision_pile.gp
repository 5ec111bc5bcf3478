# Validation: largest error of a force under static piles against processor time: damped motion to rest, and the
# static solver.
# tables: validation_precision_pile.tsv
width = 16.0
height = 8.0
load 'figures/style.gp'
data = t('validation_precision_pile.tsv')
problems = '1035 5490'
array words[2] = ['1035 disks, slopes of 60°', '5490 disks, slopes of 30°']
methods = 'verlet implicit newton'
array names[3] = ['Verlet, {/:Italic ω} d{/:Italic t} = 0.2', 'implicit, {/:Italic ω} d{/:Italic t} = 1', 'static solver']
of(p, m, col) = strcol('method') eq p.'/'.m ? column(col) : NaN
front(p, col) = strcol('method')[1:strlen(p) + 1] eq p.'/' && column('front') == 1 ? column(col) : NaN
set logscale xy
set format '10^{%T}'
set xlabel 'processor time (s)'
set xrange [2e-3:6e1]
set yrange [1e-14:1e3]
set ytics 1e3
set key bottom right Left reverse font ',7.5' samplen 1.5
set multiplot layout 1, 2 margins 0.1, 0.98, 0.14, 0.92 spacing 0.03, 0
do for [i = 1:2] {
  p = word(problems, i)
  set title words[i] font ',9' offset 0, -0.6
  if (i == 1) { set ylabel 'largest error of a force on the base / {/:Italic m g}' } else { unset ylabel; set format y ''; unset key }
  plot for [k = 1:3] data using (of(p, word(methods, k), 'seconds')):(of(p, word(methods, k), 'error')) \
         with linespoints pt int(word('7 9 13', k)) ps (k == 3 ? 1.2 : 0.55) lw 0.8 lc int(word('2 7 1', k)) title names[k], \
       data using (front(p, 'seconds')):(front(p, 'error')) with points pt 6 ps 1.4 lc 1 title 'Pareto front'
}
unset multiplot
