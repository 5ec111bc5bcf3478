# Piles of 30 degrees of growing size in the limit of hard disks: largest H over that of diagonal contacts alone, and the
# deviation of N and H from the continuum, root mean square. `make studies`.
width = 18.0
height = 8.0
load 'figures/style.gp'
# t('li_size.tsv') t('li_size_large.tsv')
set multiplot layout 1, 2
set logscale x
set xrange [60:1e6]
set format x '10^{%T}'
set xlabel 'disks'
both = "< cat ".T."li_size.tsv ".T."li_size_large.tsv | awk '/^# well/ && !n++ { print substr($0, 3) } !/^#/'"
wells = 'auto 1 100'
names = '"springs of {/:Italic K}_s" "{/:Italic a} = εσ" "{/:Italic a} = 100 εσ"'
set ylabel 'max {/:Italic H} over that of diagonal contacts alone'
set yrange [0.6:1.05]
set title '(a)'
set key top right
plot for [k = 1:3] both using (strcol('well') eq word(wells, k) ? column('n_disks_mean') : NaN):(column('H_ratio_mean')) with points pt 4 + 2*k ps 0.9 lc 2*k title word(names, k)
set ylabel 'deviation from the continuum / its maximum'
set yrange [0:0.15]
set title '(b)'
set key center right font ',9'
plot for [k = 1:3] both using (strcol('well') eq word(wells, k) ? column('n_disks_mean') : NaN):(column('H_continuum_rms_mean')) with points pt 4 + 2*k ps 0.9 lc 2*k title '{/:Italic H}, '.word(names, k), \
     for [k = 1:3] both using (strcol('well') eq word(wells, k) ? column('n_disks_mean') : NaN):(column('N_continuum_rms_mean')) with points pt 5 + 2*k ps 0.7 lc 2*k title '{/:Italic N}, '.word(names, k)
unset multiplot
