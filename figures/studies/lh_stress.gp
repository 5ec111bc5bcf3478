# Beyond Lee & Herrmann 1993: stress in the mean of 20 piles at mu = 0.2, and the forces on the base against
# those of rays at 60 degrees. Crosses: principal directions; lengths are proportional to the principal stresses.
# sweeps: lh_stress
heading = sprintf('Stress in piles and forces on their base, mean of %s piles', note('lh_stress/base.tsv', 'piles'))
panels = 2
across = 2
ratio = 0.4
legend = 3
load 'figures/style.gp'
field = t('lh_stress/field.tsv')
base = t('lh_stress/base.tsv')
c(name) = column(name)
stats field using (c('p')) nooutput name 'P'
W = 4.0
half = 0.045/P_max # of a cross, in W, for the greatest pressure
least = 0.004*P_max
tip(stress, angle) = half*stress*angle
some(v) = c('p') > least ? v : NaN
eval panel(1, '(a) mean pressure (dyn/cm); crosses: principal stresses')
set xlabel '{/:Italic x/W}'
set ylabel '{/:Italic y/W}'
set xrange [0:1]
set yrange [0:0.6]
unset grid
set palette defined (0 '#f7f7f7', 1 '#9ecae1', 2 '#3182bd')
set cbtics 100
set colorbox user horizontal origin graph 0.6, graph 1.12 size graph 0.39, graph 0.05
plot field using (c('x/W')):(c('y/W')):(some(c('p'))) with image pixels notitle, \
     '' using (some(c('x/W') - tip(c('p') + c('shear'), cos(c('direction'))))):(c('y/W') - tip(c('p') + c('shear'), sin(c('direction')))): \
       (2*tip(c('p') + c('shear'), cos(c('direction')))):(2*tip(c('p') + c('shear'), sin(c('direction')))) with vectors nohead lw 1.6 lc 'black' notitle, \
     '' using (some(c('x/W') + tip(c('p') - c('shear'), sin(c('direction'))))):(c('y/W') - tip(c('p') - c('shear'), cos(c('direction')))): \
       (-2*tip(c('p') - c('shear'), sin(c('direction')))):(2*tip(c('p') - c('shear'), cos(c('direction')))) with vectors nohead lw 0.8 lc 'black' notitle
eval panel(2, '(b) forces; dashed: where the wall was')
set grid
set xrange [0:2]
set yrange [0:*]
set ylabel 'force on the base (dyn/cm)'
set arrow 1 from 1, graph 0 to 1, graph 1 nohead ls guide
plot base using (c('x/W')):(c('weight')) with lines ls guide title 'weight above', \
     '' using (c('x/W')):(c('N_theory')) with lines ls 11 title '{/:Italic N}, rays at 60°', \
     '' using (c('x/W')):(c('H_theory')) with lines ls 12 title '{/:Italic H}, rays at 60°', \
     '' using (c('x/W')):(c('H')):(c('H_se')) with yerrorbars ls 2 pt 4 title '{/:Italic H}', \
     '' using (c('x/W')):(c('N')):(c('N_se')) with yerrorbars ls ours title '{/:Italic N}'
