# Lee & Herrmann 1993, figure 1(b): kinetic energy per grain against the iteration. Panel (a) has thousands of
# oscillations and shows them as a band; panel (b) resolves the first ones of the pile.
# sweeps: lh1
heading = 'Kinetic energy before and after opening'
remark = 'dotted: the right wall is removed'
panels = 2
load 'figures/style.gp'
opened = real(pick('lh1/row_0/phases.tsv', 'phase', 'filled', 'step'))
from = 60
to = 63
set xlabel 'iteration (thousands)'
set ylabel 'energy per grain (erg)' offset aside + 1
eval panel(1, '(a) whole run')
set logscale y
set format y '10^{%T}'
set yrange [1e-9:100]
set xrange [0:*]
set arrow 1 from opened/1000, graph 0 to opened/1000, graph 1 nohead ls guide
plot t('lh1/row_0/energy.tsv') using (column('step')/1000):(column('kinetic_per_grain')) with lines lw 0.7 lc 'black' notitle
unset arrow 1
unset logscale y
eval panel(2, '(b) oscillation of the pile')
set ylabel 'energy per grain (10^{-6} erg)' offset aside
set format y '%h'
set yrange [0:*]
set xrange [from:to]
plot t('lh1/row_0/energy.tsv') using (column('step')/1000):(within(from, to, column('step')/1000, 1e6*column('kinetic_per_grain'))) \
       with linespoints ls ours ps 0.4 lw 0.7 notitle
