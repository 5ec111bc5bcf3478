# Liffman, Chan & Hughes 1992, figure 19: forces on the base of the tent 30/45 degrees, X_1 = 0.38 B.
set xlabel '{/:Italic x / B}'
set ylabel 'force / ({/:Italic χgB})'
set xrange [0:1]
set yrange [-0.15:0.6]
set key top right
plot t('tent_30_45_38.tsv') using (column('x/B')):(column('N/(chi*g*B)')) with lines lw 1.5 lc 2 title '{/:Italic N}, α_1 = 30°, α_2 = 45°, {/:Italic X}_1 = 0.38 {/:Italic B}', \
     '' using (column('x/B')):(column('H/(chi*g*B)')) with lines lw 1.5 dt 2 lc 2 title '{/:Italic H}', \
     t('tent_45_30_38.tsv') using (column('x/B')):(column('N/(chi*g*B)')) with lines lc 3 title '{/:Italic N}, α_1 = 45°, α_2 = 30°: no dip', \
     '' using (column('x/B')):(column('H/(chi*g*B)')) with lines dt 2 lc 3 title '{/:Italic H}'
