# Effect of the half-width of the wells, of gaps between the disks of a row and of unequal disks on figures 14, 16 and
# 17 of Liffman, Chan & Hughes 1992. Base of 45 disks, eps = 1e-4, a = eps sigma where it is not varied. Diagonal
# contacts alone give 1. Unequal disks: stable states of the same random draws; bars: standard errors over piles.
# Marks of one value are shifted sideways. Steep piles of very unequal disks spread.
# tables: li_slopes_disorder.tsv li_slopes_gaps.tsv li_slopes_wells.tsv
width = 20.0
height = 20.0
load 'figures/style.gp'
set multiplot layout 4, 3 rowsfirst
set logscale x
set format x '10^{%T}'
slopes = '32.6 45 50 55 60'
marks = '6 8 4 10 12'
colours = '1 2 3 4 7'
columns = 'H_ratio H_slope_ratio N_centre weakest_level'
of(s) = column('alpha_deg') == real(word(slopes, s))
do for [row = 1:4] {
    q = word(columns, row)
    name = word('"max {/:Italic H} / diagonals alone" "slope of {/:Italic H} in the middle / same" "{/:Italic N} in the middle / max {/:Italic N}" "weakest contacts in a row"', row)
    do for [c = 1:3] {
        file = 'li_slopes_'.word('wells gaps disorder', c).'.tsv'
        varied = word('well gap disorder', c)
        if (c == 1) { set xrange [0.04:800]; set ylabel name; what = '{/:Italic a} / (εσ)' }
        if (c == 2) { set xrange [4e-6:2.5e-2]; unset ylabel; what = 'gap / σ' }
        if (c == 3) { set xrange [4e-7:2.5e-2]; what = 'disorder' }
        if (row == 1) { if (c < 3) { set yrange [0.6:1.3] } else { set logscale y; set yrange [0.5:10] } }
        if (row == 2) { unset logscale y; if (c < 3) { set yrange [0.8:1.1] } else { set yrange [-1:5] } }
        if (row == 3) { if (c < 3) { set yrange [0.9:1.02] } else { set yrange [0:1.1] } }
        if (row == 4) { set yrange [-0.03:0.75] }
        if (row == 4) { set xlabel what } else { unset xlabel }
        if (row == 2 && c == 2) { set key bottom right font ',9' } else { unset key }
        plot for [s = 1:5] t(file) using (of(s) ? 1.15**(s - 3)*column(varied) : NaN):(column(q.'_mean')):(c == 3 ? column(q.'_se') : 0) \
             with yerrorbars pt int(word(marks, s)) ps 0.8 lw 0.7 lc int(word(colours, s)) title word(slopes, s).'°'
    }
}
unset multiplot
