# Lee & Herrmann 1993, figure 5: angle of the pile just before a grain is added. Rows 0, 10 and 20 of the sweep are
# the first pile of each v_cut.
# sweeps: lh5 lh_floor
heading = 'Angle of a pile that grows grain by grain'
remark = 'vertical line: end of the transient'
panels = 2
legend = 3
load 'figures/style.gp'
level = most('lh5/row_0.tsv', 'level_step')
theta = most('lh5/row_0.tsv', 'theta_deg')
sd = most('lh5/row_0.tsv', 'theta_sd_deg')
opened = real(pick('lh_floor/points.tsv', 'floor', 'ends', 'theta_r3_deg_mean'))
from_level(x, y) = x < level ? NaN : y
v_cut(row) = '{/:Italic v}_{cut} = '.note('lh5/row_'.row.'/series.tsv', 'v_cut').' cm/s'
set ylabel '{/:Italic θ} (degrees), method 3'
set yrange [0:38]
set ytics 10
eval panel(1, '(a) fastest grains')
set xlabel 'iteration (10^5)'
set arrow 1 from level/1e5, graph 0 to level/1e5, graph 1 nohead ls guide
plot t('lh5/row_0/series.tsv') using (column('step')/1e5):(column('theta_r3_deg')) with lines lw 1 lc 'black' title v_cut('0'), \
     for [k=0:1] '' using (column('step')/1e5):(from_level(column('step'), theta + (2*k - 1)*sd)) \
       with lines ls 12 title k ? '' : 'mean ± standard deviation', \
     opened with lines ls theory title sprintf('mean {/:Italic θ}_R of opened boxes, same floor, %.1f', opened)
unset arrow 1
eval panel(2, '(b) slower grains')
set xlabel 'grains added'
plot for [row in '10 20'] t('lh5/row_'.row.'/series.tsv') using (column('insertion')):(column('theta_r3_deg')) \
       with lines lw 1 lc rgb (row eq '10' ? '#000000' : '#0072b2') title v_cut(row), \
     opened with lines ls theory notitle
