# Validation of damped impacts: restitution over the range of damping, with and without attractive damped forces, and
# its error with the bound derived from the scheme.
# tables: validation_impact_hertz.tsv validation_impact_linear.tsv
width = 17.0
height = 12.0
load 'figures/style.gp'
hertz = t('validation_impact_hertz.tsv')
linear = t('validation_impact_linear.tsv')
array tables[2] = [hertz, linear]
array titles[2] = ['Hertz, (2a)', 'linear']
array threshold[2] = [1.12799, 1.0]
array where[2] = ['from 1.12799 on', 'from 1 on']
array axis[2] = ['{/:Italic γ}_n{/:Italic m}^{2/5} {/:Italic k}^{ -2/5} {/:Italic v}^{ -1/5}', '{/:Italic γ}_n / 2({/:Italic k}/{/:Italic m})^{1/2}']
set multiplot layout 2, 2 margins 0.09, 0.98, 0.11, 0.94 spacing 0.09, 0.06
set logscale x
set format x ''
set xrange [0.009:11]
set yrange [-0.03:1.05]
do for [k = 1:2] {
  set title titles[k]
  set ylabel (k == 1 ? 'restitution' : '')
  set key bottom left font ',8' Left reverse
  set arrow 1 from threshold[k], graph 0 to threshold[k], graph 1 nohead dt 2 lc rgb '#606060' lw 0.8
  set label 1 where[k]."\nattractive forces:\npairs stick" at 1.15*threshold[k], graph 0.93 left font ',8'
  plot tables[k] using (column('damping')):(column('pulls_exact')) with lines lc 3 title 'attraction allowed, exact', \
       '' using (column('damping')):(column('pulls')) with points pt 6 ps 0.6 lc 3 title 'simulated', \
       '' using (column('damping')):(column('pushes_exact')) with lines lc 7 dt 4 title 'force ≥ 0, exact', \
       '' using (column('damping')):(column('pushes')) with points pt 8 ps 0.6 lc 7 title 'simulated'
}
unset title
set format x '%g'
set logscale y
set format y '10^{%T}'
set yrange [1e-7:2e-2]
do for [k = 1:2] {
  set xlabel axis[k]
  set ylabel (k == 1 ? 'error of the restitution' : '')
  set key top left font ',8' Left reverse maxrows 2
  set label 1 "time step: 1/1000\nof the elastic\ncontact, or less" at 1.15*threshold[k], graph 0.93 left font ',8'
  set arrow 1 from threshold[k], graph 0 to threshold[k], graph 1 nohead dt 2 lc rgb '#606060' lw 0.8
  plot tables[k] using (column('damping')):(column('pulls_error')) with points pt 6 ps 0.6 lc 3 title 'attraction allowed', \
       '' using (column('damping')):(column('pulls_bound')) with lines lc 3 title 'bound', \
       '' using (column('damping')):(column('pushes_error')) with points pt 8 ps 0.6 lc 7 title 'force ≥ 0', \
       '' using (column('damping')):(column('pushes_bound')) with lines lc 7 dt 4 title 'bound'
}
unset multiplot
