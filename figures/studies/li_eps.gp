# The equilateral pile of 45 layers: deviation of N from hard disks against eps = m g/(K_s sigma), symmetric state;
# slope by least squares over the stable points.
# tables: li_eps_runs.tsv li_eps_slope.tsv
set xlabel 'ε'
set ylabel 'relative deviation of {/:Italic N}'
set logscale xy
set format xy '10^{%T}'
set key top left Left reverse
slope = system("grep -v '^#' ".path("li_eps_slope.tsv")." | sed 1d | cut -f 1 | xargs printf %.4f")
from = real(pick('li_eps_runs.tsv', 'eps', '1e-6', 'N_error_rms'))
plot [5e-9:2e-3] from*x/1e-6 with lines lc rgb '#888888' dt 2 title 'proportional to ε', \
     t('li_eps_runs.tsv') using (column('eps')):(column('N_error_rms')) with points pt 7 ps 0.8 lc 2 title 'root mean square: slope '.slope.' where stable', \
     t('li_eps_runs.tsv') using (column('eps')):(column('N_error_max')) with points pt 8 ps 0.8 lc 3 title 'largest', \
     t('li_eps_runs.tsv') using (column('negative_modes') > 0 ? column('eps') : NaN):(column('N_error_rms')) \
       with points pt 6 ps 1.6 lc 7 title 'unstable'
