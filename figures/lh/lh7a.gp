# Lee & Herrmann 1993, figure 7(a): measured theta_R + theta_T against theta_MS of (3).
# tables: lh3_compare.tsv lh5.tsv
stats t('lh3_compare.tsv') using (column('n')) nooutput name 'P'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'angle (degrees)'
set xrange [-0.01:0.32]
set yrange [0:48]
set key top left Left reverse
set label 1 sprintf('bars: standard error over %d piles, {/:Italic θ}_T by displacement', P_max) at graph 0.98, 0.05 right font ',8'
plot t('lh3_compare.tsv') using (column('mu')):(column('theta_rt_deg')):(column('theta_rt_se_deg')) \
       with yerrorbars pt 7 ps 0.7 lc 2 title '{/:Italic θ}_R + {/:Italic θ}_T measured, sum for each pile', \
     '' using (column('mu')):(column('theta_ms_deg')) with linespoints pt 6 ps 0.5 lc 7 title '{/:Italic θ}_{MS} = atan 3{/:Italic μ}, eq. (3)', \
     '' using (column('mu')):(column('theta_rt_balanced_deg')) with linespoints pt 8 ps 0.6 lc 3 dt 2 title '{/:Italic θ}_R measured + {/:Italic θ}_T of (4), forces balanced', \
     t('lh5.tsv') using (0.2):(column('v_cut') == 0.1 ? column('theta_ms_flux_deg_mean') : NaN):(column('theta_ms_flux_deg_se')) \
       with yerrorbars pt 9 ps 0.9 lc 4 title '{/:Italic θ}_{MS} measured by flux, floor ends at the opening'
