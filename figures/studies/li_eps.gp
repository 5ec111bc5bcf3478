# The equilateral pile of 45 layers: deviation of N from hard disks against eps = m g/(K_s sigma), symmetric state;
# slope by least squares over the stable points.
# sweeps: li_eps
heading = 'Forces of soft disks approach those of hard disks'
remark = 'circles: unstable piles'
legend = 3
load 'figures/style.gp'
set xlabel 'ε'
set ylabel 'relative deviation of {/:Italic N}'
set logscale xy
set format xy '10^{%T}'
set ylabel offset powers
slope = most('li_eps/slope.tsv', 'slope')
from = real(pick('li_eps/runs.tsv', 'eps', '1e-6', 'N_error_rms'))
plot [5e-9:2e-3] from*x/1e-6 with lines ls theory title 'proportional to ε', \
     t('li_eps/runs.tsv') using (column('eps')):(column('N_error_rms')) with points ls ours title sprintf('root mean square: slope %.4f where stable', slope), \
     t('li_eps/runs.tsv') using (column('eps')):(column('N_error_max')) with points ls 2 title 'largest', \
     t('li_eps/runs.tsv') using (column('negative_modes') > 0 ? column('eps') : NaN):(column('N_error_rms')) \
       with points pt 6 ps 1.6 lw 1.5 lc rgb '#d55e00' notitle
