# Softness above which the symmetric state of an equilateral pile of k layers is unstable.
# sweeps: li_threshold
heading = 'Softness above which the symmetric pile is unstable'
remark = 'equilateral piles, {/:Italic k_x} = {/:Italic K_s}'
load 'figures/style.gp'
set xlabel '{/:Italic k}'
set ylabel 'ε_c {/:Italic k}^3'
set logscale x
set xrange [3.5:110]
set yrange [0:6]
set xtics (4, 8, 16, 32, 64)
plot t('li_threshold/runs.tsv') using (column('base')):(column('eps_c')*column('base')**3) with linespoints ls ours notitle
