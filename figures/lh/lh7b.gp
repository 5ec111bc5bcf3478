# Lee & Herrmann 1993, figure 7(b): measured theta_T against (4) at the measured theta_R, as printed and with balanced forces.
# sweeps: lh3 lh3_box
heading = 'Tilting angle: measured, and by (4)'
remark = sprintf('bars: standard error over %d piles, %d in the turned box (theory: bootstrap of {/:Italic θ}_R); series shifted sideways', most('lh3/compare.tsv', 'n'), most('lh3_box/compare.tsv', 'n'))
legend = 4
load 'figures/style.gp'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:10]
forms = 'printed lattice'
form(k) = word('"(4) as printed" "(4) with balanced forces, rays fixed to the lattice"', k)
plot for [k=1:2] t('lh3/compare.tsv') using (column('mu')):(column('theta_t_'.word(forms, k).'_deg')):(column('theta_t_'.word(forms, k).'_se_deg')) \
       with yerrorlines ls 10 + k title form(k), \
     t('lh3/compare.tsv') using (column('mu')):(column('theta_t_deg')):(column('theta_t_se_deg')) with yerrorbars ls ours title 'measured, gravity turned', \
     t('lh3_box/compare.tsv') using (column('mu') - 0.003):(column('theta_t_deg')):(column('theta_t_se_deg')) with yerrorbars ls 3 title 'measured, box turned as in the paper'
