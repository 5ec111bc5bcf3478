# Validation: error of a rebound against the time step, for each law and integrator, and the fitted orders.
# sweeps: order
heading = 'Error of a rebound against the time step'
remark = 'filled: Verlet, open: Gear; orders of velocity and position in the key; points: root mean square over phases of the first and last contact; lines: slopes 1, 2 and 5/2'
panels = 2
shared = 11
load 'figures/style.gp'
data = t('order/order.tsv')
cases = 'paper hertz_pulls linear_slips linear_elastic hertz_elastic'
array words[5] = ['Hertz, damped, friction', 'Hertz, strongly damped', \
                  'linear, friction, undamped', 'linear, elastic', 'Hertz, elastic']
located = 'paper/located_full_step'
order(case, col) = system(rows_do('order/fits.tsv', '', is('case', case).' { printf "%.3f ± %.3f", $c["'.col.'_order"], $c["'.col.'_order_se"] }'))
orders(case) = order(case, 'velocity').', '.order(case, 'position')
of(case, col) = strcol('case') eq case ? column(col) : NaN
set logscale xy
set format xy '10^{%T}'
set ylabel offset powers
set xrange [3e-4:0.12]
set yrange [1e-10:0.3]
set xlabel 'time step / contact time'
do for [k=1:2] {
  eval panel(k, word('"(a) velocity / impact speed" "(b) position / (speed × contact time)"', k))
  col = word('velocity_error position_error', k)
  set ylabel 'error'
  plot x with lines ls guide notitle, x**2 with lines ls guide notitle, 0.02*x**2.5 with lines ls guide notitle, \
       for [i=1:5] data using (1/column('steps')):(of(word(cases, i).'/gear5', col)) with points ls i ps 1.1 pt int(word('6 4 8 10 14', i)) \
         title words[i].'; Gear: '.orders(word(cases, i).'/gear5'), \
       data using (1/column('steps')):(of(located, col)) with points ls 12 pt 1 title 'first, contact located within the step; Verlet: '.orders(located), \
       for [i=1:5] data using (1/column('steps')):(of(word(cases, i).'/verlet', col)) with points ls i title words[i].'; Verlet: '.orders(word(cases, i).'/verlet')
}
