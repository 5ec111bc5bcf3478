# Lee & Herrmann 1993, section 3: friction of grains against friction of floor and walls, in boxes of three sizes.
# tables: lh_grain_trend.tsv lh_wall.tsv lh_wall_trend.tsv lh_wall_trend_bottom.tsv
stats t('lh_wall.tsv') using (column('n')) nooutput name 'P'
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel 'change from {/:Italic μ} = 0.1 to 0.4 (degrees)'
set xrange [1.5:5.5]
set yrange [-10:40]
set key top left Left reverse
set arrow 1 from graph 0, first 0 to graph 1, first 0 nohead lc rgb '#888888' lw 0.7
set label 1 sprintf('straight lines through the means; bars: standard error over %d piles; the other friction is 0.2', P_max) at graph 0.98, 0.05 right font ',7'
plot t('lh_grain_trend.tsv') using (column('W')):(column('change')):(column('change_se')) \
       with yerrorbars pt 7 ps 0.7 lc 2 title '{/:Italic θ}_R, friction between grains', \
     t('lh_wall_trend.tsv') using (column('W') + 0.05):(column('change')):(column('change_se')) \
       with yerrorbars pt 5 ps 0.7 lc 3 title '{/:Italic θ}_R, friction of floor and walls', \
     t('lh_wall_trend_bottom.tsv') using (column('W') + 0.1):(column('change')):(column('change_se')) \
       with yerrorbars pt 9 ps 0.7 lc 4 title 'slope of the lower half minus slope of the upper half, floor and walls'
