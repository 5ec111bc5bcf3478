# Forces under static piles of 30 degrees, and under the tent of Fig. 19 of Liffman, Chan & Hughes 1992, with 45 disks
# in the base. Varied: the half-width of the wells, gaps between the disks of a row (a = eps sigma), at eps = 1e-4. The
# middle is the mean N within 0.1 B of the centre less that from 0.1 to 0.2 B, over the mean N; a dip is negative.
# Unequal disks: li_disorder.gp.
# sweeps: li_gaps li_wells
heading = 'Forces against the width of the wells, and gaps'
panels = 4
shared = 2
load 'figures/style.gp'
shapes = 'auto 45'
of(k, x) = strcol('inner_deg') eq word(shapes, k) ? x : NaN
outline_of(k) = word('"triangle, 30°" "tent, 30° and 45°"', k)
quantities = 'H_ratio middle'
set logscale x
set format x '10^{%T}'
do for [c=1:2] for [row=1:2] {
    varied = word('well gap', c)
    q = word(quantities, row)
    eval panel(2*row + c - 2, sprintf('(%s) %s', word('a b c d', 2*row + c - 2), word('"largest {/:Italic H}" "{/:Italic N} of the middle less its neighbours"', row)))
    set xlabel word('"{/:Italic a} / (εσ)" "gap / σ"', c)
    set ylabel word('"ratio to diagonals alone" "over the mean {/:Italic N}"', row)
    if (c == 1) { set xrange [0.05:5000] } else { set xrange [5e-7:2e-2] }
    if (row == 1) { set yrange [0.6:1.1] }
    if (row == 2) { set yrange [-0.15:0.15] }
    data = c == 1 ? t('li_wells/points.tsv') : t('li_gaps/points.tsv')
    plot for [k=1:2] data using (of(k, column(varied))):(row == 1 ? 1 : column(q.'_diagonals_mean')) with lines ls theory + k - 1 title outline_of(k).', diagonals alone', \
         for [k=1:2] data using (of(k, column(varied))):(column(q.'_mean')) with points ls (k == 1 ? 1 : 2) title outline_of(k)
}
