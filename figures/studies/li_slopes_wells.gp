# Effect of the half-width of the wells on figures 14, 16 and 17 of Liffman, Chan & Hughes 1992. Base of 45 disks, eps =
# 1e-4. Diagonal contacts alone give 1 in (a) and (b). (c): mean N within 0.1 B of the middle less that from 0.1 to 0.2 B, over
# the mean N. figures/studies/li_slopes_gaps.gp and li_slopes_disorder.gp draw by this file.
# sweeps: li_slopes_wells
if (!exists('varied')) { varied = 'well'; heading = 'Forces under piles against the width of the wells'; what = '{/:Italic a} / (εσ)'; data = 'li_slopes_wells/points.tsv'; lowest = 0.04; highest = 800 }
remark = 'slope of the pile: symbols; marks of one value are shifted sideways'
panels = 4
shared = 1
load 'figures/style.gp'
slopes = '32.6 45 50 55 60'
columns_of = 'H_ratio H_slope_ratio middle weakest_level'
of(s) = column('alpha_deg') == real(word(slopes, s))
name(k) = word('"(a) largest {/:Italic H}" "(b) slope of {/:Italic H} in the middle" "(c) {/:Italic N} of the middle less its neighbours" "(d) weakest contacts"', k)
unit(k) = word('"ratio to that of diagonals alone" "ratio to that of diagonals alone" "over the mean {/:Italic N}" "fraction in a row"', k)
set logscale x
set format x '10^{%T}'
set xrange [lowest:highest]
set xlabel what
do for [k=1:4] {
    eval panel(k, name(k))
    q = word(columns_of, k)
    set ylabel unit(k)
    plot for [s=1:5] t(data) using (of(s) ? 1.15**(s - 3)*column(varied) : NaN):(column(q.'_mean')):(varied eq 'disorder' ? column(q.'_se') : 0) \
         with yerrorbars ls s title word(slopes, s).'°'
}
