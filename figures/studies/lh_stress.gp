# Beyond Lee & Herrmann 1993: stress in the mean of 20 piles at mu = 0.2, and the forces on the base against
# those of rays at 60 degrees. Crosses: principal directions; lengths are proportional to the principal stresses.
# tables: lh_stress_base.tsv lh_stress_field.tsv
width = 18.0
height = 13.0
load 'figures/style.gp'
field = t('lh_stress_field.tsv')
base = t('lh_stress_base.tsv')
c(name) = column(name)
n = note('lh_stress_base.tsv', 'piles')
stats field using (c('p')) nooutput name 'P'
W = 4.0
half = 0.045/P_max # of a cross, in W, for the greatest pressure
least = 0.004*P_max
tip(stress, angle) = half*stress*angle
some(v) = c('p') > least ? v : NaN
set multiplot
set size 1.0, 0.52
set origin 0.0, 0.48
set lmargin at screen 0.10
set rmargin at screen 0.86
set xlabel '{/:Italic x/W}'
set ylabel '{/:Italic y/W}'
set xrange [0:1]
set yrange [0:0.6]
unset grid
set palette defined (0 '#f7f7f7', 1 '#9ecae1', 2 '#3182bd')
set cblabel 'mean pressure (dyn/cm)'
set label 1 'mean of '.n.' piles' at graph 0.98, 0.9 right
plot field using (c('x/W')):(c('y/W')):(some(c('p'))) with image pixels notitle, \
     '' using (some(c('x/W') - tip(c('p') + c('shear'), cos(c('direction'))))):(c('y/W') - tip(c('p') + c('shear'), sin(c('direction')))): \
       (2*tip(c('p') + c('shear'), cos(c('direction')))):(2*tip(c('p') + c('shear'), sin(c('direction')))) with vectors nohead lw 1.6 lc 8 notitle, \
     '' using (some(c('x/W') + tip(c('p') - c('shear'), sin(c('direction'))))):(c('y/W') - tip(c('p') - c('shear'), cos(c('direction')))): \
       (-2*tip(c('p') - c('shear'), sin(c('direction')))):(2*tip(c('p') - c('shear'), cos(c('direction')))) with vectors nohead lw 0.8 lc 8 notitle
unset label 1
set size 1.0, 0.48
set origin 0.0, 0.0
set grid
set xrange [0:2]
set yrange [0:*]
set ylabel 'force on the base (dyn/cm)'
set key top right
set arrow 1 from 1, graph 0 to 1, graph 1 nohead lc rgb '#808080' dt 2
plot base using (c('x/W')):(c('N')):(c('N_se')) with yerrorbars pt 7 ps 0.7 lc 2 title '{/:Italic N}', \
     '' using (c('x/W')):(c('weight')) with lines lc 8 dt 3 title 'weight above', \
     '' using (c('x/W')):(c('N_theory')) with lines lc 2 title '{/:Italic N}, rays at 60°', \
     '' using (c('x/W')):(c('H')):(c('H_se')) with yerrorbars pt 6 ps 0.7 lc 7 title '{/:Italic H}', \
     '' using (c('x/W')):(c('H_theory')) with lines lc 7 title '{/:Italic H}, rays at 60°'
unset multiplot
