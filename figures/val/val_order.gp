# Validation: error of a rebound against the time step, for each law and integrator, and the fitted orders.
# tables: validation_order.tsv validation_order_fits.tsv
width = 18.0
height = 12.0
load 'figures/style.gp'
data = t('validation_order.tsv')
cases = 'paper hertz_pulls linear_slips linear_elastic hertz_elastic'
colours = '2 7 4 8 6'
array words[5] = ['Hertz, damped, friction: as Lee and Herrmann', 'Hertz, strongly damped', \
                  'linear, friction, undamped', 'linear, elastic', 'Hertz, elastic']
located = 'paper/located_full_step'
order(case, col) = system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, \"\t\"); for (i = 1; i <= n; i++) c[a[i]] = i; next } $c[\"case\"] == \"".case."\" { printf \"%.3f ± %.3f\", $c[\"".col."_order\"], $c[\"".col."_order_se\"] }' ".path('validation_order_fits.tsv'))
orders(case) = 'velocity '.order(case, 'velocity').', place '.order(case, 'place')
of(case, col) = strcol('case') eq case ? column(col) : NaN
set multiplot
set logscale xy
set format y '10^{%T}'
set format x '10^{%T}'
set xrange [3e-4:0.12]
set xlabel 'time step / contact time' offset 0,0.4
set key at screen 0.47, 0.005 bottom center Left reverse maxrows 13 font ',7.5' samplen 1.5 spacing 1.05
set tmargin at screen 0.99
set bmargin at screen 0.395
do for [panel=1:2] {
  set lmargin at screen panel == 1 ? 0.085 : 0.59
  set rmargin at screen panel == 1 ? 0.485 : 0.99
  if (panel == 2) { unset key }
  col = panel == 1 ? 'velocity_error' : 'position_error'
  set yrange [1e-10:0.3]
  set ylabel (panel == 1 ? 'error of velocity / impact speed' : 'error of position / (speed × contact time)') font ',9' offset 1.2,0
  plot for [i=1:5] data using (1/column('steps')):(of(word(cases, i).'/verlet', col)) with points pt 7 ps 0.5 lc int(word(colours, i)) \
         title words[i].'; Verlet: '.orders(word(cases, i).'/verlet'), \
       for [i=1:5] data using (1/column('steps')):(of(word(cases, i).'/gear5', col)) with points pt 6 ps 1 lc int(word(colours, i)) \
         title words[i].'; Gear: '.orders(word(cases, i).'/gear5'), \
       data using (1/column('steps')):(of(located, col)) with points pt 8 ps 0.9 lc 1 \
         title 'first law, contact located within the step, damping at the full step; Verlet: '.orders(located), \
       x with lines dt 2 lc rgb '#808080' title 'slopes 1, 2 and 5/2; points: root mean square over phases of touch and parting', \
       x**2 with lines dt 2 lc rgb '#808080' notitle, 0.02*x**2.5 with lines dt 2 lc rgb '#808080' notitle
}
unset multiplot
