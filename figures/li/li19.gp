# Liffman, Chan & Hughes 1992, figure 19: forces on the base of the tent of 30 and 45 degrees, X_1 = 0.38 B: continuum, and
# disks with 90 in the base: diagonal contacts alone, soft disks with stiff and with soft wells.
# sweeps: pile tent
stiff = 'pile/tent_90_30_45_38_1e-5_1.tsv'
soft = 'pile/tent_90_30_45_38_1e-5_1000.tsv'
heading = 'Forces on the base of the tent of 30° and 45°'
panels = 4
shared = 3
load 'figures/style.gp'
B = real(note(stiff, 'B'))
set xlabel '{/:Italic x / B}'
set xrange [0:1]
do for [k=1:2] {
    q = word('N H', k)
    f = q.'/(chi*g*B)'
    eval panel(k, word('"(a) normal force" "(b) horizontal force"', k))
    set ylabel '{/:Italic '.q.'} / ({/:Italic χgB})'
    if (k == 1) { set yrange [0:0.42] } else { set yrange [-0.1:0.1] }
    other = "t('tent/45_30_38.tsv') using (column('x/B')):(column(f)) with lines ls guide title 'continuum, 45° outside, 30° inside: no dip', "
    curves = "t('tent/30_45_38.tsv') using (column('x/B')):(column(f)) with lines ls theory title 'continuum', ".\
         "t(stiff) using (column('x/B')):(column(q.'_diagonals/mg')/B) with points ls 2 pt 2 title 'diagonal contacts alone', ".\
         "t(soft) using (column('x/B')):(column(f)) with points ls 3 title 'soft disks, wells of 1000 εσ', ".\
         "t(stiff) using (column('x/B')):(column(f)) with points ls ours title 'soft disks, wells of εσ'"
    if (k == 1) { of_normal = curves }
    eval 'plot '.(k == 1 ? other : '').curves
}
eval panel(3, '(c) normal force, the middle')
set ylabel '{/:Italic N} / ({/:Italic χgB})'
set xrange [0.25:0.75]
set yrange [0.22:0.29]
q = 'N'
f = 'N/(chi*g*B)'
eval 'plot '.of_normal
eval panel(4, '(d) normal force less continuum')
set ylabel 'difference'
set xrange [0:1]
set yrange [-0.06:0.06]
plot 0 with lines ls theory notitle, \
     less(soft, 'tent/30_45_38.tsv', f) using (column('x')):(column('less')) with points ls 3 notitle, \
     less(stiff, 'tent/30_45_38.tsv', f) using (column('x')):(column('less')) with points ls ours notitle
