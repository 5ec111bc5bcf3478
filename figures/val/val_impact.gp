# Validation of damped impacts: restitution over the range of damping, with and without attractive damped forces, and
# its error with the bound derived from the scheme.
# sweeps: impact
heading = 'Restitution of damped impacts, and its error'
remark = 'dashed: damping from which attractive forces hold pairs; time step: 1/1000 of the elastic contact, or less'
panels = 4
shared = 3
load 'figures/style.gp'
hertz = t('impact/hertz.tsv')
linear = t('impact/linear.tsv')
array tables[2] = [hertz, linear]
array titles[2] = ['Hertz, (2a)', 'linear']
array threshold[2] = [1.12799, 1.0]
array axis[2] = ['{/:Italic γ}_n{/:Italic m}^{2/5} {/:Italic k}^{ -2/5} {/:Italic v}^{ -1/5}', '{/:Italic γ}_n / 2({/:Italic k}/{/:Italic m})^{1/2}']
set logscale x
set format x '%g'
set xrange [0.009:11]
do for [k=1:4] {
  j = (k - 1)%2 + 1
  eval panel(k, sprintf('(%s) %s, %s', word('a b c d', k), titles[j], k < 3 ? 'restitution' : 'error of the restitution'))
  set xlabel axis[j]
  set ylabel k < 3 ? 'restitution' : 'error'
  set arrow 1 from threshold[j], graph 0 to threshold[j], graph 1 nohead ls guide
  if (k < 3) { set yrange [-0.03:1.05] } else { set logscale y; set format y '10^{%T}'; set ylabel offset powers; set yrange [1e-7:2e-2] }
  kind = k < 3 ? '' : '_error'
  theory_of = k < 3 ? '_exact' : '_bound'
  plot for [i=1:2] tables[j] using (column('damping')):(column(word('pulls pushes', i).theory_of)) with lines ls 10 + i title word('"attraction allowed" "force ≥ 0"', i).', exact, or bound', \
       for [i=1:2] tables[j] using (column('damping')):(column(word('pulls pushes', i).kind)) with points ls i title word('"attraction allowed" "force ≥ 0"', i).', simulated'
}
