# Piles of 30 degrees of growing size in the limit of hard disks: largest H over that of diagonal contacts alone, and
# the deviation of N and H from the continuum, root mean square. Lines: limit + c/base by least squares, bases of 180
# and more, for the wells close to the limit. Bases of 23 and 45 are in brackets: the steps at their ends differ from
# those of the others. `make studies`.
# sweeps: li_size
heading = 'Piles of 30° of growing size in the limit of hard disks'
remark = 'lines: limit + {/:Italic c}/base for the wells close to the limit; small points: bases of 23 and 45, whose ends have other steps'
panels = 2
legend = 6
load 'figures/style.gp'
set logscale x
set xrange [60:1e6]
set format x '10^{%T}'
set xlabel 'disks'
both = t('li_size/points.tsv')
wells = 'auto 1 100'
names_of = '"springs of {/:Italic K}_s" "{/:Italic a} = εσ" "{/:Italic a} = 100 εσ"'
at(k, others) = strcol('well') eq word(wells, k) && others == (column('base') < 60) ? column('n_disks_mean') : NaN
fit_of(what, k, name) = real(system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, FS); for (i = 1; i <= n; i++) c[a[i]] = i; next } $1 == \"".word(wells, k)."\" { print $c[\"".name."\"] }' ".path("li_size/limit_180_".what.".tsv")))
array limit[6]; array c[6]
whats = 'H_ratio H_continuum_rms N_continuum_rms'
do for [q = 1:3] { do for [k = 1:2] {
    limit[2*q + k - 2] = fit_of(word(whats, q), k, 'limit')
    c[2*q + k - 2] = fit_of(word(whats, q), k, 'c')
} }
# base of a pile of n disks: n = base (base + 3)/6
base(n) = (sqrt(9 + 24*n) - 3)/2
line(q, k, n) = limit[2*q + k - 2] + c[2*q + k - 2]/base(n)
set ylabel 'largest {/:Italic H}, ratio'
set yrange [0.68:0.96]
eval panel(1, '(a) ratio to diagonal contacts alone')
plot for [k=1:2] within(5490, 1e6, x, line(1, k, x)) with lines ls 10 + k notitle, \
     for [k=1:3] both using (at(k, 1)):(column('H_ratio_mean')) with points ls k ps 0.35 notitle, \
     for [k=1:3] both using (at(k, 0)):(column('H_ratio_mean')) with points ls k title word(names_of, k)
set ylabel 'rms deviation / maximum'
set yrange [0:0.15]
eval panel(2, '(b) deviation from the continuum')
plot for [k=1:2] for [q=2:3] within(5490, 1e6, x, line(q, k, x)) with lines ls 10 + k notitle, \
     for [q=1:2] for [k=1:3] both using (strcol('well') eq word(wells, k) ? column('n_disks_mean') : NaN):(column(word('H N', q).'_continuum_rms_mean')) \
       with points ls k pt int(word('7 5 9', k)) - (q == 2) title '{/:Italic '.word('H N', q).'}, '.word(names_of, k)
