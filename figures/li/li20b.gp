# Liffman, Chan & Hughes 1992, figure 20(b), for an ensemble: mean pressure on the base of dropped piles, averaged over
# both sides, with standard errors over piles. D is D_raw of `repose stress dip`; D_excess is its D, the excess over a
# triangle of the same slopes. figures/studies/li20_sources.gp draws more kinds of piles by this file.
# tables: continuum_30.tsv li20_point_dip.tsv li20_point_dip_raw.tsv li20_point_profile.tsv
set xlabel 'distance from the centroid of the load / {/:Italic B}'
set ylabel '{/:Italic N} / mean {/:Italic N}'
set xrange [0:0.5]
set yrange [0:2.8]
set key top right font ',8' spacing 1.1
set arrow 1 from 0.1, graph 0 to 0.1, first 1.95 nohead dt 3 lc rgb '#888888'
set arrow 2 from 0.3, graph 0 to 0.3, first 1.95 nohead dt 3 lc rgb '#888888'
stats t('continuum_30.tsv') using (column('N/(chi*g*B)')) nooutput name 'C'
if (!exists('files')) { files = 'point'; names = '"dropped at one point"' }
cell(name, col) = system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, \"\t\"); next } { for (i = 1; i <= n; i++) if (a[i] == \"".col."\") print $i }' ".path(name))
pm(table) = sprintf('%.3f ± %.3f', real(cell(table, 'D')), real(cell(table, 'D_se')))
label(k) = sprintf('%s, %s piles: {/:Italic D} = %s, {/:Italic D}_{excess} = %s', word(names, k), cell('li20_'.word(files, k).'_dip.tsv', 'n'), \
                  pm('li20_'.word(files, k).'_dip_raw.tsv'), pm('li20_'.word(files, k).'_dip.tsv'))
plot 2 - 4*x with lines dt 2 lc rgb '#888888' title 'weight above: triangle', \
     t('continuum_30.tsv') using (0.5 - column('x/B') >= 0 ? 0.5 - column('x/B') : NaN):(column('N/(chi*g*B)')/C_mean) with lines dt 4 lc rgb '#444444' title 'continuum, 30°', \
     for [k = 1:words(files)] t('li20_'.word(files, k).'_profile.tsv') using (column('distance')):(column('N')):(column('N_se')) \
       with yerrorlines lc k + (k < 4 ? 1 : 2) pt 2*k + 3 ps 0.6 title label(k)
