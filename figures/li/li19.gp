# Liffman, Chan & Hughes 1992, figure 19: forces on the base of the tent of 30 and 45 degrees, X_1 = 0.38 B: continuum, and
# disks with 90 in the base: diagonal contacts alone, soft disks with stiff and with soft wells.
# tables: pile_tent_90_30_45_38_1e-5_1.tsv pile_tent_90_30_45_38_1e-5_3000.tsv tent_30_45_38.tsv tent_45_30_38.tsv
width = 18.0
height = 8.0
load 'figures/style.gp'
stiff = 'pile_tent_90_30_45_38_1e-5_1.tsv'
soft = 'pile_tent_90_30_45_38_1e-5_3000.tsv'
set multiplot layout 1, 2
set xlabel '{/:Italic x / B}'
set xrange [0:1]
do for [q in 'N H'] {
    col = q.'/(chi*g*B)'
    set ylabel '{/:Italic '.q.'} / ({/:Italic χgB})'
    if (q eq 'N') { set title '(a)'; set yrange [0:0.42]; set key bottom center font ',8' }
    if (q eq 'H') { set title '(b)'; set yrange [-0.1:0.1]; unset key }
    plot t('tent_30_45_38.tsv') using (column('x/B')):(column(col)) with lines lw 1.5 lc 1 title 'continuum', \
         t('tent_45_30_38.tsv') using (column('x/B')):(q eq 'N' ? column(col) : NaN) with lines dt 2 lc rgb '#888888' title 'continuum, 45° outside, 30° inside: no dip', \
         t(stiff) using (column('x/B')):(column(q.'_diagonals/mg')/real(note(stiff, 'B'))) with points pt 2 ps 0.7 lw 0.5 lc 3 title 'diagonal contacts alone', \
         t(stiff) using (column('x/B')):(column(col)) with points pt 6 ps 0.5 lc 7 title 'soft disks, wells of εσ', \
         t(soft) using (column('x/B')):(column(col)) with points pt 8 ps 0.5 lc 4 title 'soft disks, wells of 3000 εσ'
}
unset multiplot
