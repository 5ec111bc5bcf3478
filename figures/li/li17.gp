# Liffman, Chan & Hughes 1992, figure 17: the pile of 32.6 degrees, the slope of Smid & Novosad's experiment. The
# paper's text does not contain its curves. Bar: statement of the text, N at the centre 20 % (small piles) to 30 %
# (large piles) below the largest N.
# sweeps: claims continuum pile
soft = 'pile/45_32.6_1e-4.tsv'
heading = 'Forces on the base of the pile of 32.6°'
panels = 2
legend = 4
load 'figures/style.gp'
small = real(note('claims/published.tsv', 'dip_small'))
large = real(note('claims/published.tsv', 'dip_large'))
B = real(note(soft, 'B'))
set xlabel '{/:Italic x / B}'
set xrange [0:1]
do for [k=1:2] {
    q = word('H N', k)
    f = q.'/(chi*g*B)'
    stats t(soft) using (abs(column(f))) nooutput name 'S'
    eval panel(k, word('"(a) horizontal force" "(b) normal force"', k))
    set ylabel '{/:Italic '.q.'} / max |{/:Italic '.q.'}|'
    set yrange [k == 1 ? -1.5 : 0:k == 1 ? 1.5 : 1.2]
    curves = "t('continuum/32.6.tsv') using (column('x/B')):(column(f)/S_max) with lines ls theory title 'continuum', ".\
         "t(soft) using (column('x/B')):(column(q.'_diagonals/mg')/S_max/B) with points ls 2 pt 2 title 'diagonal contacts alone', ".\
         "t(soft) using (column('x/B')):(column(f)/S_max) with points ls ours title note(soft, 'n_disks').' soft disks'"
    experiment = ", '+' using (0.5):(1 - 0.5*(large + small)):(1 - large):(1 - small) every ::0::0 with yerrorbars ls paper pt 0 title 'experiment, at the centre'"
    eval 'plot '.curves.(k == 2 ? experiment : '')
}
