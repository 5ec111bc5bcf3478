# Liffman, Chan & Hughes 1992, figure 18: outlines of tents.
# sweeps: tent
heading = 'Outlines of two tents'
panels = 2
ratio = 0.5
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x / B}'
set ylabel '{/:Italic y / B}'
set xrange [0:1]
set yrange [0:0.5]
set ytics 0.1
do for [k=1:2] {
    outer = word('45 30', k)
    inner = word('30 45', k)
    eval panel(k, sprintf('(%s) α_1 = %s°, α_2 = %s°', word('a b', k), outer, inner))
    plot t('tent/'.outer.'_'.inner.'_38.tsv') using (column('x/B')):(column('y/B')) with filledcurves y1=0 fc rgb grain notitle, \
         '' using (column('x/B')):(column('y/B')) with lines lw 1.5 lc rgb '#000000' notitle
}
