# Lee & Herrmann 1993, figure 4: tilting angle against friction.
# tables: lh3.tsv lh3_fit_theta_t.tsv
fit = path('lh3_fit_theta_t.tsv')
slope = real(system("awk '!/^#/ && $NF == \"free\" { print $1 }' ".fit))
start = real(system("awk '!/^#/ && $NF == \"free\" { print $3 }' ".fit))
stats t('lh3.tsv') using (column('n')) nooutput name 'P'
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel 'tilting angle {/:Italic θ}_T (degrees)'
set xrange [-0.01:0.32]
set yrange [0:10]
set key top left Left reverse
set label 1 sprintf('gravity rotated by %s degree per step; bars: standard error over %d piles; series shifted by 0.003', note('lh3.tsv', 'tilt_rate_deg'), P_max) at graph 0.98, 0.05 right font ',8'
plot t('lh3.tsv') using (column('mu')):(column('theta_t_displacement_deg_mean')):(column('theta_t_displacement_deg_se')) \
       with yerrorbars pt 7 ps 0.7 lc 2 title '5 % of the grains moved by 0.1 {/:Italic d}', \
     '' using (column('mu') + 0.003):(column('theta_t_energy_deg_mean')):(column('theta_t_energy_deg_se')) \
       with yerrorbars pt 4 ps 0.7 lc 3 title 'kinetic energy above 10^{-5} {/:Italic mgd} and the elastic sway', \
     [0.05:0.2] start + slope*x with lines lc 2 dt 2 title 'straight line, 0.05 ≤ {/:Italic μ} ≤ 0.2'
