# Liffman, Chan & Hughes 1992, figure 13: normal force on the base for four slopes, 45 disks in the base: soft disks
# in equilibrium at eps = 1e-4 (spring wells of K_s), forces of diagonal contacts alone in the same piles, and the
# continuum (54)-(59). Unit: largest value of the soft disks.
# tables: continuum_30.tsv continuum_45.tsv continuum_50.tsv continuum_55.tsv pile_45_30_1e-4.tsv pile_45_45_1e-4.tsv
#    pile_45_50_1e-4.tsv pile_45_55_1e-4.tsv
width = 17.0
height = 13.0
load 'figures/style.gp'
set multiplot layout 2, 2
set xlabel '{/:Italic x / B}'
set ylabel '{/:Italic N} / max {/:Italic N}'
set xrange [0:1]
set yrange [0:1.19]
do for [angle in '30 45 50 55'] {
    soft = 'pile_45_'.angle.'_1e-4.tsv'
    stats t(soft) using (abs(column('N/(chi*g*B)'))) nooutput name 'S'
    set title 'α = '.angle.'°, '.note(soft, 'n_disks').' disks'
    if (angle eq '30') { set key bottom center font ',9' } else { unset key }
    plot t('continuum_'.angle.'.tsv') using (column('x/B')):(column('N/(chi*g*B)')/S_max) with lines lw 1.5 lc 1 title 'continuum', \
         t(soft) using (column('x/B')):(column('N/(chi*g*B)')/S_max) with points pt 6 ps 0.6 lc 7 title 'soft disks', \
         t(soft) using (column('x/B')):(column('N_diagonals/mg')/S_max/real(note(soft, 'B'))) with points pt 2 ps 0.7 lw 0.5 lc 3 title 'diagonal contacts alone'
}
unset multiplot
