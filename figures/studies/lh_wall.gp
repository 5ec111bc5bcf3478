# Lee & Herrmann 1993, section 3: what friction of the grains, of the floor and of the walls changes, against the size of the box.
# sweeps: lh_floor_upper lh_grain lh_rough_16 lh_rough_large
heading = 'Friction of grains, floor and walls'
remark = sprintf('friction from 0.1 to 0.4, the others 0.2; bars: standard error, %d piles a point of the floor', \
                 most('lh_floor_upper/points.tsv', 'n'))
legend = 4
sample = 0
load 'figures/style.gp'
set xlabel 'size of the box {/:Italic W} = {/:Italic H} (cm)'
set ylabel 'change of the slope (degrees)'
set logscale x 2
set xrange [1.7:19]
set yrange [-8:24]
set xzeroaxis ls guide
plot t('lh_grain/trend.tsv') using (column('W')):(column('change')):(column('change_se')) \
       with yerrorbars ls 1 title 'friction of the grains: whole surface', \
     t('lh_floor_upper/trend.tsv') using (column('W')*1.03):(column('change')):(column('change_se')) \
       with yerrorbars ls 2 title 'of the floor: whole surface', \
     t('lh_floor_upper/trend_top.tsv') using (column('W')*1.06):(column('change')):(column('change_se')) \
       with yerrorbars ls 3 title 'of the floor: upper half', \
     t('lh_rough_large/trend_walls.tsv') using (column('W')*1.09):(column('change')):(column('change_se')) \
       with yerrorbars ls 4 title 'of the walls: whole surface', \
     t('lh_rough_16/trend_walls.tsv') using (column('W')*1.09):(column('change')):(column('change_se')) \
       with yerrorbars ls 4 notitle
