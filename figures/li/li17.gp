# Liffman, Chan & Hughes 1992, figure 17: the pile of 32.6 degrees, the slope of Smid & Novosad's experiment. The
# paper's text does not contain its curves. Bar: statement of the text, N at the centre 20 % (small piles) to 30 %
# (large piles) below the largest N.
# tables: continuum_32.6.tsv pile_45_32.6_1e-4.tsv published.tsv
width = 18.0
height = 8.0
load 'figures/style.gp'
soft = 'pile_45_32.6_1e-4.tsv'
small = published('li17-small', 'published')
large = published('li17-large', 'published')
set multiplot layout 1, 2
set xlabel '{/:Italic x / B}'
set xrange [0:1]
set key top left Left reverse font ',9'
do for [q in 'H N'] {
    col = q.'/(chi*g*B)'
    stats t(soft) using (abs(column(col))) nooutput name 'S'
    if (q eq 'H') {
        set title '(a)'; set ylabel '{/:Italic H} / max |{/:Italic H}|'; set yrange [-1.5:1.5]
    } else {
        set title '(b)'; set ylabel '{/:Italic N} / max {/:Italic N}'; set yrange [0:1.3]; set key bottom center
    }
    plot t('continuum_32.6.tsv') using (column('x/B')):(column(col)/S_max) with lines lw 1.5 lc 1 title 'continuum', \
         t(soft) using (column('x/B')):(column(col)/S_max) with points pt 6 ps 0.6 lc 7 title note(soft, 'n_disks').' soft disks', \
         t(soft) using (column('x/B')):(column(q.'_diagonals/mg')/S_max/real(note(soft, 'B'))) with points pt 2 ps 0.7 lw 0.5 lc 3 title 'diagonal contacts alone', \
         '+' using (q eq 'N' ? 0.5 : NaN):(1 - large):(0):(large - small) every ::0::0 with vectors heads size 0.012,90 lw 2 lc 2 title (q eq 'N' ? 'experiment, at the centre only' : '')
}
unset multiplot
