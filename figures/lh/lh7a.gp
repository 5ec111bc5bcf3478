# Lee & Herrmann 1993, figure 7(a): measured theta_R + theta_T against theta_MS of (3).
# sweeps: lh3 lh3_box
heading = 'Marginal stability: measured, and by (3)'
remark = sprintf('bars: standard error over %d piles, %d in the turned box; {/:Italic θ}_T by displacement', most('lh3/compare.tsv', 'n'), most('lh3_box/compare.tsv', 'n'))
legend = 3
load 'figures/style.gp'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'angle (degrees)'
set xrange [-0.01:0.32]
set yrange [0:45]
plot t('lh3/compare.tsv') using (column('mu')):(column('theta_ms_deg')) with lines ls theory title '{/:Italic θ}_{MS} = atan 3{/:Italic μ}, equation (3)', \
     t('lh3/compare.tsv') using (column('mu')):(column('theta_rt_deg')):(column('theta_rt_se_deg')) \
       with yerrorbars ls ours title '{/:Italic θ}_R + {/:Italic θ}_T measured, gravity turned', \
     t('lh3_box/compare.tsv') using (column('mu') - 0.003):(column('theta_rt_deg')):(column('theta_rt_se_deg')) \
       with yerrorbars ls 2 title '{/:Italic θ}_R + {/:Italic θ}_T measured, box turned as in the paper'
