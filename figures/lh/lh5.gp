# Lee & Herrmann 1993, figure 5: angle of the pile just before a grain is added. Row 0 of the sweep is the first pile of the
# paper's v_cut; beside it all piles of three v_cut, and boxes that are opened on the same floor.
# sweeps: lh5 lh_floor lh_floor_tilt
heading = 'Angle of a pile that grows grain by grain'
remark = 'vertical line: end of the transient; (b) mean of each pile after it, bars: standard deviation; at the right the slope of each opened box'
panels = 2
legend = 3
load 'figures/style.gp'
level = most('lh5/row_0.tsv', 'level_step')
theta = most('lh5/row_0.tsv', 'theta_deg')
sd = most('lh5/row_0.tsv', 'theta_sd_deg')
# all boxes that were opened on the same floor, which ends
of_floor(what) = real(pick('lh_floor/points.tsv', 'floor', 'ends', 'theta_r3_deg_'.what))
of_tilt(what) = real(pick('lh_floor_tilt/points.tsv', 'tilt', 'box', 'theta_r3_deg_'.what))
opened = (of_floor('mean')*of_floor('n') + of_tilt('mean')*of_tilt('n'))/(of_floor('n') + of_tilt('n'))
from_level(x, y) = x < level ? NaN : y
v_cut = sprintf('{/:Italic v}_{cut} = %g cm/s', most('lh5/runs.tsv', 'v_cut'))
set ylabel '{/:Italic θ} (degrees), method 3'
set yrange [0:38]
set ytics 10
eval panel(1, '(a) against the iteration')
set xlabel 'iteration (10^5)'
set arrow 1 from level/1e5, graph 0 to level/1e5, graph 1 nohead ls guide
plot t('lh5/row_0/series_theta.tsv') using (column('step')/1e5):(column('theta')) with lines lw 1 lc 'black' title v_cut, \
     for [k=0:1] '' using (column('step')/1e5):(from_level(column('step'), theta + (2*k - 1)*sd)) \
       with lines ls 12 title k ? '' : 'mean ± standard deviation', \
     opened with lines ls theory title sprintf('mean {/:Italic θ}_R of opened boxes, same floor, %.1f', opened)
unset arrow 1
eval panel(2, '(b) each pile after the transient')
set xlabel '{/:Italic v}_{cut} (cm/s)' offset -4, upwards
set xrange [0.4:4.6]
set yrange [12:30]
set xtics ('0.1' 1, '0.01' 2, '0.001' 3, 'opened' 4)
x(v) = column('v_cut') == v ? 0.03*column('replica') - 0.15 - log10(v) : NaN
plot for [v in '0.1 0.01 0.001'] t('lh5/runs.tsv') using (x(real(v))):(column('theta_deg')):(column('theta_sd_deg')) with yerrorbars ls 1 notitle, \
     t('lh_floor/runs.tsv') using (stringcolumn('floor') eq 'ends' ? 3.85 + 0.03*column('replica') : NaN):(column('theta_r3_deg')) with points ls 2 notitle, \
     opened with lines ls theory notitle
