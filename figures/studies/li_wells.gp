# Forces under static piles of 30 degrees, and under the tent of Fig. 19 of Liffman, Chan & Hughes 1992, with 45 disks
# in the base. Varied: the half-width of the wells, gaps between the disks of a row (a = eps sigma), unequal disks.
# Unequal disks: stable states of the same random draws; bars: standard errors over piles; H summed outwards over both
# halves; deviation of N from diagonals alone; eps = 1e-4 and 1e-6 shifted sideways. Dashed: diagonals alone. A
# negative D is a dip of N in the middle.
# tables: li_disorder.tsv li_gaps.tsv li_wells.tsv
width = 20.0
height = 16.0
load 'figures/style.gp'
set multiplot layout 3, 3 columnsfirst
set logscale x
shapes = 'auto 45'
names = '"triangle, 30°" "tent, 30° and 45°"'
shape(k) = strcol("inner_deg") eq word(shapes, k)
do for [f in 'wells gaps'] {
    file = 'li_'.f.'.tsv'
    if (f eq 'wells') { q = 'well'; set xrange [0.05:5000]; set xtics 100; set format x '10^{%T}'; what = '{/:Italic a} / (εσ), ε = 10^{-4}' }
    if (f eq 'gaps') { q = 'gap'; set xrange [5e-7:2e-2]; what = 'gap / σ, ε = 10^{-4}' }
    set xlabel what
    set key top left Left reverse font ',9'
    set yrange [0.6:1.15]
    set ylabel 'max {/:Italic H} / diagonals alone'
    plot for [k = 1:2] t(file) using (shape(k) ? column(q) : NaN):(column('H_ratio_mean')) with points pt 4 + 2*k ps 0.8 lc 4*k - 1 title word(names, k)
    unset key
    set yrange [-0.32:0.32]
    set ylabel '{/:Italic D}'
    plot for [k = 1:2] t(file) using (shape(k) ? column(q) : NaN):(column('D_mean')) with points pt 4 + 2*k ps 0.8 lc 4*k - 1, \
         for [k = 1:2] t(file) using (shape(k) ? column(q) : NaN):(column('D_diagonals_mean')) with lines dt 2 lc 4*k - 1
    set yrange [0.88:1.02]
    set ylabel '{/:Italic N} in the middle / max {/:Italic N}'
    plot for [k = 1:2] t(file) using (shape(k) ? column(q) : NaN):(column('N_centre_mean')) with points pt 4 + 2*k ps 0.8 lc 4*k - 1, \
         for [k = 1:2] t(file) using (shape(k) ? column(q) : NaN):(column('N_centre_diagonals_mean')) with lines dt 2 lc 4*k - 1
}
file = 'li_disorder.tsv'
of(k, e) = shape(k) && (e == 1) == (column('eps') > 1e-5)
# closed marks, shifted to the left: eps = 1e-4; open marks, shifted to the right: eps = 1e-6
point(k, e) = 4 + 2*k + (e == 1)
place(k, e) = of(k, e) ? column('disorder')/column('eps')*(e == 1 ? 0.75 : 1/0.75) : NaN
set xrange [5e-3:2e4]
set xlabel 'disorder / ε'
set key top left Left reverse font ',8'
set yrange [0.5:4]
set ylabel 'outward {/:Italic H} / diagonals alone'
plot for [k = 1:2] for [e = 1:2] t(file) using (place(k, e)):(column('thrust_ratio_mean')):(column('thrust_ratio_se')) \
     with yerrorbars pt point(k, e) ps 0.9 lw 0.7 lc 4*k - 1 title word(names, k).', ε = 10^{'.(e == 1 ? '-4' : '-6').'}'
unset key
set yrange [-0.32:0.32]
set ylabel '{/:Italic D}'
plot for [k = 1:2] for [e = 1:2] t(file) using (place(k, e)):(column('D_mean')):(column('D_se')) \
     with yerrorbars pt point(k, e) ps 0.9 lw 0.7 lc 4*k - 1, \
     for [k = 1:2] t(file) using (of(k, 1) || of(k, 2) ? column('disorder')/column('eps') : NaN):(column('D_diagonals_mean')) smooth unique with lines dt 2 lc 4*k - 1
set yrange [0:1]
set ylabel 'rms deviation of {/:Italic N}'
plot for [k = 1:2] for [e = 1:2] t(file) using (place(k, e)):(column('N_error_rms_mean')):(column('N_error_rms_se')) \
     with yerrorbars pt point(k, e) ps 0.9 lw 0.7 lc 4*k - 1
unset multiplot
