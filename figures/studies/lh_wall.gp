# Lee & Herrmann 1993, section 3: friction of grains against friction of floor and walls, in boxes of three sizes.
# sweeps: lh_grain lh_wall
heading = 'Change with friction of grains and of walls'
remark = sprintf('change of a straight line through the means; bars: standard error, %d (grains) and %d piles a point; the other friction is 0.2', \
                 most('lh_grain/points.tsv', 'n'), most('lh_wall/points.tsv', 'n'))
legend = 3
load 'figures/style.gp'
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel 'change, {/:Italic μ} 0.1 to 0.4 (degrees)'
set xrange [1.5:5.5]
set yrange [-10:25]
set xzeroaxis ls guide
plot t('lh_grain/trend.tsv') using (column('W')):(column('change')):(column('change_se')) \
       with yerrorbars ls 1 title '{/:Italic θ}_R, friction between grains', \
     t('lh_wall/trend.tsv') using (column('W') + 0.05):(column('change')):(column('change_se')) \
       with yerrorbars ls 2 title '{/:Italic θ}_R, friction of floor and walls', \
     t('lh_wall/trend_bottom.tsv') using (column('W') + 0.1):(column('change')):(column('change_se')) \
       with yerrorbars ls 3 title 'lower minus upper half, floor and walls'
