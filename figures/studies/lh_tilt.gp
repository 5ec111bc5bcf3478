# Onset of motion under tilt against the tilting rate; gravity or the box is rotated.
# tables: lh_tilt.tsv lh_tilt_static.tsv
width = 18.0
height = 8.0
load 'figures/style.gp'
tilts = t('lh_tilt.tsv')
rests = t('lh_tilt_static.tsv')
pick(mu, tilt, column) = sprintf("< awk -F'\t' '/^#/ { next } !n { n = NF; for (i = 1; i <= n; i++) c[$i] = i; next } $c[\"mu\"] == %g && $c[\"tilt\"] == \"%s\" { print $c[\"tilt_rate_deg\"] \"\t\" $c[\"%s_mean\"] \"\t\" $c[\"%s_se\"] }' ", mu, tilt, column, column).path('lh_tilt.tsv')
rest(mu, tilt) = real(system(sprintf("awk -F'\t' '/^#/ { next } !n { n = NF; for (i = 1; i <= n; i++) c[$i] = i; next } $c[\"mu\"] == %g && $c[\"tilt\"] == \"%s\" { print $c[\"theta_t_static_deg_mean\"] }' ", mu, tilt).path('lh_tilt_static.tsv')))
unset datafile
set datafile separator tab
set datafile missing 'nan'
set logscale x
set format x '10^{%T}'
set xrange [2e-5:1.6e-3]
set xlabel 'rotation per step (degrees)'
set yrange [0:10]
set multiplot layout 1, 2
set key top left Left reverse font ',7.5' spacing 1
do for [mu in '0.1 0.2'] {
    set title '{/:Italic μ} = '.mu font ',9'
    set ylabel mu eq '0.1' ? 'tilting angle {/:Italic θ}_T (degrees)' : ''
    plot pick(real(mu), 'gravity', 'theta_t_displacement_deg') using 1:2:3 with yerrorlines pt 7 ps 0.7 lc 3 title 'gravity rotated, displacement', \
         pick(real(mu), 'gravity', 'theta_t_energy_deg') using ($1*1.06):2:3 with yerrorlines pt 6 ps 0.7 lc 3 dt 2 title 'gravity rotated, energy', \
         pick(real(mu), 'box', 'theta_t_displacement_deg') using 1:2:3 with yerrorlines pt 5 ps 0.7 lc 7 title 'box rotated, displacement', \
         pick(real(mu), 'box', 'theta_t_energy_deg') using ($1*1.06):2:3 with yerrorlines pt 4 ps 0.7 lc 7 dt 2 title 'box rotated, energy', \
         rest(real(mu), 'gravity') with lines lc 3 dt 3 title 'gravity rotated, 0.1° at a time to rest', \
         rest(real(mu), 'box') with lines lc 7 dt 3 title 'box rotated, 0.1° at a time to rest'
    unset key
    set label 1 'bars: standard error over piles' at graph 0.98, 0.04 right font ',7'
}
unset multiplot
