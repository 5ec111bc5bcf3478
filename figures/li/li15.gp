# Liffman, Chan & Hughes 1992, figure 15: piles of 30 degrees of 360 and 5490 disks at eps = 1e-4, and of 21780 in the limit
# eps -> 0, against the continuum (54)-(59).
# sweeps: continuum pile
heading = 'Forces on the base of piles of 30° of growing size'
panels = 4
shared = 2
load 'figures/style.gp'
set xlabel '{/:Italic x / B}'
set xrange [0:1]
do for [k=1:2] {
    f = word('N H', k)
    eval panel(k, word('"(a) normal force" "(b) horizontal force"', k))
    set ylabel '{/:Italic '.f.'} / ({/:Italic χgB})'
    if (k == 1) { set yrange [0:0.33] } else { set yrange [-0.07:0.07] }
    f = f.'/(chi*g*B)'
    plot t('continuum/30.tsv') using (column('x/B')):(column(f)) with lines ls theory title 'continuum', \
         t('pile/360_30_0.tsv') using (column('x/B')):(column(f)) with lines lw 2 lc rgb '#009e73' title '21780 disks, ε → 0', \
         t('pile/180_30_1e-4.tsv') using (column('x/B')):(column(f)) with lines ls 12 title '5490 disks', \
         t('pile/45_30_1e-4.tsv') using (column('x/B')):(column(f)) with points ls ours title '360 disks'
}
do for [k=1:2] {
    f = word('N H', k)
    eval panel(k + 2, word('"(c) normal force less continuum" "(d) horizontal force less continuum"', k))
    set ylabel 'difference'
    set yrange [-0.03:0.03]
    set ytics 0.01
    f = f.'/(chi*g*B)'
    plot 0 with lines ls theory notitle, \
         less('pile/180_30_1e-4.tsv', 'continuum/30.tsv', f) using (column('x')):(column('less')) with lines ls 12 notitle, \
         less('pile/45_30_1e-4.tsv', 'continuum/30.tsv', f) using (column('x')):(column('less')) with points ls ours notitle
}
