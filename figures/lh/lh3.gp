# Lee & Herrmann 1993, figure 3: angle of repose against friction.
# tables: lh3.tsv lh3_fit_theta_r.tsv lh3_total.tsv published.tsv
fit = path('lh3_fit_theta_r.tsv')
slope = real(system("awk '!/^#/ && $NF == \"free\" { print $1 }' ".fit))
start = real(system("awk '!/^#/ && $NF == \"free\" { print $3 }' ".fit))
stats t('lh3.tsv') using (column('n')) nooutput name 'P'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'angle of repose {/:Italic θ}_R (degrees), method 3'
set xrange [-0.01:0.32]
set yrange [0:38]
set key top left Left reverse
set label 1 sprintf('bars: standard error over %d piles; series shifted by 0.003; at {/:Italic μ} = 0 no pile is stable', P_max) at graph 0.98, 0.05 right font ',8'
plot t('lh3.tsv') using (column('mu')):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars pt 7 ps 0.7 lc 2 title 'spring truncated at the Coulomb limit, at rest', \
     t('lh3_total.tsv') using (column('mu') + 0.003):(column('theta_r3_deg_mean')):(column('theta_r3_deg_se')) \
       with yerrorbars pt 4 ps 0.7 lc 3 title 'spring as (2b) is printed, '.note('lh3_total.tsv', 'relax_steps').' steps after opening', \
     [0.05:0.2] start + slope*x with lines lc 2 dt 2 title 'straight line, 0.05 ≤ {/:Italic μ} ≤ 0.2', \
     '+' using (0.207):(published('lh-theta', 'published')):(published('lh-theta', 'published_se')) every ::0::0 with yerrorbars pt 9 ps 0.9 lc 1 title 'Lee and Herrmann 1993, text (bar as printed)'
