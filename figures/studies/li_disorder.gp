# Forces under static piles of unequal disks of 30 degrees, and under the tent of Fig. 19 of Liffman, Chan & Hughes
# 1992, with 45 disks in the base: stable states of the same random draws. The middle is
# the mean N within 0.1 B of the centre less that from 0.1 to 0.2 B, over the mean N; a dip is negative.
# sweeps: li_disorder
heading = 'Unequal disks: thrust, dip and scatter against disorder over softness'
remark = 'bars: standard error over piles; {/:Italic H} summed outwards over both halves; ε = 10^{-4} and 10^{-6} shifted sideways'
panels = 3
shared = 3
load 'figures/style.gp'
shapes = 'auto 45'
of(k) = strcol('inner_deg') eq word(shapes, k)
at(k, e) = of(k) && (e == 1) == (column('eps') > 1e-5) ? column('disorder')/column('eps')*(e == 1 ? 0.75 : 1/0.75) : NaN
name(k, e) = word('"triangle, 30°" "tent, 30° and 45°"', k).', ε = 10^{'.(e == 1 ? '-4' : '-6').'}'
quantities = 'thrust_ratio middle N_error_rms'
disorder = t('li_disorder/points.tsv')
set logscale x
set format x '10^{%T}'
set xrange [5e-3:2e4]
set xlabel 'disorder / ε'
do for [row=1:3] {
    q = word(quantities, row)
    eval panel(row, word('"(a) outward {/:Italic H}" "(b) {/:Italic N} of the middle less its neighbours" "(c) scatter of {/:Italic N}"', row))
    set ylabel word('"ratio to diagonals alone" "over the mean {/:Italic N}" "rms deviation of {/:Italic N}"', row)
    if (row == 1) { set yrange [0.5:4] }
    if (row == 2) { set yrange [-0.4:0.15] }
    if (row == 3) { set yrange [0:1] }
    plot for [k=1:2] disorder using (of(k) ? column('disorder')/column('eps') : NaN):(row == 1 ? 1 : row == 2 ? column('middle_diagonals_mean') : 0) smooth unique with lines ls theory + k - 1 title word('"triangle" "tent"', k).', diagonals alone', \
         for [k=1:2] for [e=1:2] disorder using (at(k, e)):(column(q.'_mean')):(column(q.'_se')) with yerrorbars ls k pt 4*k + 2 - 2*k + (e == 1) title name(k, e)
}
