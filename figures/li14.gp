# Liffman, Chan & Hughes 1992, figure 14: horizontal force on the base for four slopes; continuum (54)-(59), and the
# force that diagonal contacts alone carry in a pile of disks with 45 in its base.
set xlabel '{/:Italic x / B}'
set ylabel '{/:Italic H} / ({/:Italic χgB})'
set xrange [0:1]
set yrange [-0.26:0.26]
set key top left Left reverse font ',8'
# t('continuum_30.tsv') t('continuum_45.tsv') t('continuum_50.tsv') t('continuum_55.tsv') t('lattice_30.tsv') t('lattice_45.tsv') t('lattice_50.tsv') t('lattice_55.tsv')
angles = '30 45 50 55'
colours = '2 3 4 7'
plot for [k = 1:4] t('continuum_'.word(angles, k).'.tsv') using (column('x/B')):(column('H/(chi*g*B)')) \
       with lines lc int(word(colours, k)) lw 1.5 title 'α = '.word(angles, k).'°, continuum', \
     for [k = 1:4] t('lattice_'.word(angles, k).'.tsv') using (column('x/B')):(column('H/(chi*g*B)')) \
       with points pt 2*k + 2 ps 0.55 lc int(word(colours, k)) title 'diagonal contacts alone'
