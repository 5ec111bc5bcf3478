# Lee & Herrmann 1993, figure 7(b): measured theta_T against (4) at the measured theta_R, as printed and with balanced forces.
# sweeps: lh3 lh3_box
heading = 'Tilting angle: measured, and by (4)'
remark = sprintf('bars: standard error over %d piles, %d in the turned box, mostly smaller than the marks', most('lh3/compare.tsv', 'n'), most('lh3_box/compare.tsv', 'n'))
legend = 6
load 'figures/style.gp'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:12]
forms = 'printed lattice'
form(k) = word('"(4) as printed" "(4) with balanced forces, rays fixed to the lattice"', k)
measured(name, by) = sprintf("t('%s/points.tsv') using (column('mu')):(column('theta_t_%s_deg_mean')):(column('theta_t_%s_deg_se')) with yerrorbars", name, by, by)
eval "plot for [k=1:2] t('lh3/compare.tsv') using (column('mu')):(column('theta_t_'.word(forms, k).'_deg')) with lines ls 10 + k title form(k), ".\
     measured('lh3', 'displacement')." ls 1 title 'gravity turned, by displacement', ".\
     measured('lh3', 'energy')." ls 1 pt 6 title 'gravity turned, by kinetic energy', ".\
     measured('lh3_box', 'displacement')." ls 3 title 'box turned as in the paper, by displacement', ".\
     measured('lh3_box', 'energy')." ls 3 pt 8 title 'box turned, by kinetic energy'"
