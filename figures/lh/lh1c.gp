# Lee & Herrmann 1993, figure 1(c): 1600 grains, at rest after the avalanche. Line width between centres is
# proportional to the normal force, in twelve steps.
# tables: lh1/pile_contacts.tsv lh1/pile_grains.tsv
width = 18.0
height = 7.0
load 'figures/style.gp'
grains = t('lh1/pile_grains.tsv')
contacts = t('lh1/pile_contacts.tsv')
stats contacts using (column('normal_force')) nooutput name 'F'
classes = 12
thickest = 3.0
set size ratio -1
set xlabel '{/:Italic x} (cm)'
set ylabel '{/:Italic y} (cm)'
set xrange [-0.4:24.2]
set yrange [-0.3:7]
unset grid
set key above
class(f) = ceil(classes*f/F_max)
plot grains using (column('x')):(column('y')):(column('r')) with circles lw 0.4 fs empty border lc rgb '#b0b0b0' notitle, \
     for [k = 1:classes] contacts using (class(column('normal_force')) == k ? column('x') : NaN):(column('y')): \
       (column('x_b') - column('x')):(column('y_b') - column('y')) with vectors nohead lw thickest*(k - 0.5)/classes lc 2 notitle, \
     NaN with lines lw thickest lc 2 title sprintf('largest normal force, %.0f dyn', F_max)
