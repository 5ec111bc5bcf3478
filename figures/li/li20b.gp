# Liffman, Chan & Hughes 1992, figure 20(b), for an ensemble: mean pressure on the base of dropped piles, both sides
# together, with standard errors, and the pressure of 60-degree rays under the piles' own
# outlines. The middle is N within 0.1 B less that from 0.1 to 0.2 B, over the mean N. figures/studies/li20_sources.gp draws more kinds of
# piles by this file.
# sweeps: li20_point
if (!exists('kinds')) { kinds = 'point/'; kind_names = '"dropped at one point"' }
dip(k, col) = real(system(rows_do('li20_'.word(kinds, k).'dip.tsv', '', '{ print $c["'.col.'"] }')))
piles(k) = sprintf('%s, %d piles', word(kind_names, k), dip(k, 'n'))
heading = 'Mean pressure on the base of dropped piles'
kinds_n = words(kinds)
panels = kinds_n > 1 ? kinds_n : 2
remark = (kinds_n > 1 ? '' : piles(1).'; over the whole base the two coincide; ').(exists('made') ? made.'; ' : '').'bars: standard errors; dotted: bounds of the middle and its neighbours'
legend = 2
load 'figures/style.gp'
label(k) = sprintf('mean of the piles, middle %.3f ± %.3f', dip(k, 'middle'), dip(k, 'middle_se'))
set xlabel 'distance from the centroid of the load / {/:Italic B}'
set ylabel '{/:Italic N} / mean {/:Italic N}'
set xrange [0:0.5]
set yrange [0:1.75]
set arrow 1 from 0.1, graph 0 to 0.1, graph 1 nohead ls guide
set arrow 2 from 0.2, graph 0 to 0.2, graph 1 nohead ls guide
do for [k=1:kinds_n] {
    profile = t('li20_'.word(kinds, k).'profile.tsv')
    eval panel(k, kinds_n > 1 ? sprintf('(%s) %s', word('a b c d e f', k), piles(k)) : '(a) whole base')
    plot profile using (column('distance')):(column('rays')) with lines ls theory title '60-degree rays under the outlines', \
         profile using (column('distance')):(column('N')):(column('N_se')) with yerrorbars ls ours title label(k)
}
if (kinds_n == 1) {
    eval panel(2, '(b) the middle')
    set xrange [0:0.25]
    set yrange [1.28:1.42]
    plot profile using (column('distance')):(column('rays')) with lines ls theory notitle, \
         profile using (column('distance')):(column('N')):(column('N_se')) with yerrorlines ls ours notitle
}
