# Liffman, Chan & Hughes 1992, figure 20(b), for an ensemble: mean pressure on the base of dropped piles, averaged over
# both sides, with standard errors over piles. D is D_raw of `repose stress dip`; D_excess is its D, the excess over a
# triangle of the same slopes. figures/studies/li20_sources.gp draws more kinds of piles by this file.
# tables: continuum_30.tsv li20_point_dip.tsv li20_point_dip_raw.tsv li20_point_profile.tsv
if (!exists('kinds')) { kinds = 'point'; kind_names = '"dropped at one point"' }
dip(k, col) = real(system(rows_do('li20_'.word(kinds, k).'_dip.tsv', '', '{ print $c["'.col.'"] }')))
raw(k, col) = real(system(rows_do('li20_'.word(kinds, k).'_dip_raw.tsv', '', '{ print $c["'.col.'"] }')))
piles(k) = sprintf('%s, %d piles', word(kind_names, k), dip(k, 'n'))
heading = 'Mean pressure on the base of dropped piles'
panels = words(kinds)
remark = (panels > 1 ? '' : piles(1).'; ').'bars: standard error over piles; dotted: bounds of {/:Italic D}'
legend = 3
load 'figures/style.gp'
label(k) = sprintf('{/:Italic D} = %.2f ± %.2f, {/:Italic D}_{excess} = %.2f ± %.2f', raw(k, 'D'), raw(k, 'D_se'), dip(k, 'D'), dip(k, 'D_se'))
set xlabel 'distance from the centroid of the load / {/:Italic B}'
set ylabel '{/:Italic N} / mean {/:Italic N}'
set xrange [0:0.5]
set yrange [0:2.4]
set arrow 1 from 0.1, graph 0 to 0.1, graph 1 nohead ls guide
set arrow 2 from 0.3, graph 0 to 0.3, graph 1 nohead ls guide
stats t('continuum_30.tsv') using (column('N/(chi*g*B)')) nooutput name 'C'
do for [k=1:panels] {
    eval panel(k, panels > 1 ? sprintf('(%s) %s', word('a b c d', k), piles(k)) : '')
    plot 2 - 4*x with lines ls 12 title 'weight above: triangle', \
         t('continuum_30.tsv') using (0.5 - column('x/B') >= 0 ? 0.5 - column('x/B') : NaN):(column('N/(chi*g*B)')/C_mean) with lines ls theory title 'continuum, 30°', \
         t('li20_'.word(kinds, k).'_profile.tsv') using (column('distance')):(column('N')):(column('N_se')) with yerrorlines ls ours title label(k)
}
