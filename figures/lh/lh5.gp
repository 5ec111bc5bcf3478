# Lee & Herrmann 1993, figure 5: angle of the pile just before a grain is added. Rows 0, 10 and 20 of the sweep are
# the first pile of each v_cut.
# tables: lh5_row0.tsv lh5_row0/series.tsv lh5_row10/series.tsv lh5_row20/series.tsv lh_floor.tsv
width = 14.0
height = 11.0
load 'figures/style.gp'
stats t('lh5_row0.tsv') using (column('theta_deg')) nooutput name 'THETA'
stats t('lh5_row0.tsv') using (column('theta_sd_deg')) nooutput name 'SD'
stats t('lh5_row0.tsv') using (column('level_step')) nooutput name 'LEVEL'
floors = t('lh_floor.tsv')
stats floors using (strcol('floor') eq 'ends' ? column('theta_r3_deg_mean') : NaN) nooutput name 'R'
set multiplot layout 2, 1
set ylabel '{/:Italic θ} (degrees), method 3'
set yrange [0:38]
set ytics 10
set key top right font ',8' spacing 1
set xlabel 'iteration (10^5)'
set arrow 1 from LEVEL_mean/1e5, graph 0 to LEVEL_mean/1e5, graph 0.1 nohead lc rgb '#888888'
set label 1 ' end of the transient' at LEVEL_mean/1e5, graph 0.06 font ',8'
line(x, from, y) = x < from ? NaN : y
plot t('lh5_row0/series.tsv') using (column('step')/1e5):(column('theta_r3_deg')) with lines lw 0.7 lc 2 \
       title '{/:Italic v}_{cut} = '.note('lh5_row0/series.tsv', 'v_cut').' cm/s', \
     '' using (column('step')/1e5):(line(column('step'), LEVEL_mean, THETA_mean - SD_mean)) with lines dt 3 lc 1 \
       title 'mean ± standard deviation', \
     '' using (column('step')/1e5):(line(column('step'), LEVEL_mean, THETA_mean + SD_mean)) with lines dt 3 lc 1 notitle, \
     R_mean with lines dt 2 lc 4 title sprintf('mean {/:Italic θ}_R of opened boxes, same floor, %.1f', R_mean)
unset arrow 1
unset label 1
set xlabel 'grains added'
plot for [row in '10 20'] t('lh5_row'.row.'/series.tsv') using (column('insertion')):(column('theta_r3_deg')) \
       with lines lw 0.7 lc (row eq '10' ? 3 : 6) title '{/:Italic v}_{cut} = '.note('lh5_row'.row.'/series.tsv', 'v_cut').' cm/s', \
     R_mean with lines dt 2 lc 4 notitle
unset multiplot
