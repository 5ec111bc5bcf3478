# Why unequal sizes change a lattice so much: static triangles by disorder over softness, and the same by the dynamic simulation
# with friction between the disks.
# sweeps: li_lattice li_scale
heading = 'Unequal disks in a lattice: disorder over softness, and friction'
remark = sprintf('triangles of 30°, %d and %d piles to a setting, means with standard errors; (a) excess: {/:Italic N} of the middle less that of diagonal contacts alone; (b) less that of 60-degree rays', most('li_scale/points.tsv', 'excess_n'), most('li_lattice/points.tsv', 'excess_n'))
panels = 2
legend = 3
sample = 0
load 'figures/style.gp'
set logscale x
set format x '10^{%T}'
set xrange [5e-4:2e4]
set xlabel '{/:Italic S} / ε'
c(name) = column(name)
eval panel(1, '(a) static, base of 15 (open) and 45 disks')
set ylabel 'excess (% of mean {/:Italic N})'
shift(k) = 0.85 + 0.15*(k - 1)
of(b, k) = c('base') == b && abs(c('eps')*10**(k + 3) - 1) < 0.01 ? shift(k)*c('disorder')/c('eps') : NaN
plot for [k=1:3] t('li_scale/points.tsv') using (of(45, k)):(100*c('excess_mean')):(100*c('excess_se')) with yerrorbars ls k title 'ε = 10^{-'.(k + 3).'}', \
     for [k=1:3] '' using (of(15, k)):(100*c('excess_mean')):(100*c('excess_se')) with yerrorbars ls k pt (k == 1 ? 6 : k == 2 ? 4 : 8) notitle
eval panel(2, '(b) dynamic, base of 45 disks')
set ylabel 'excess (% of mean {/:Italic N})'
mu(k) = abs(c('mu') - (k == 1 ? 0 : k == 2 ? 0.1 : 0.5)) < 0.01 ? shift(k)*c('radius_width')/c('eps') : NaN
plot for [k=1:3] t('li_lattice/points.tsv') using (mu(k)):(100*c('excess_mean')):(100*c('excess_se')) with yerrorbars ls k title '{/:Italic μ} = '.word('0 0.1 0.5', k)
