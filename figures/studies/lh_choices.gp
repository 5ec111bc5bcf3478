# Lee & Herrmann 1993, section 4: what the five printed angles say of the mass of a grain, the filling and the shear spring.
# sweeps: claims lh_ramp
heading = 'The five printed angles, for each choice'
remark = sprintf('%d piles a setting; crosses: more than a tenth of the piles of a setting fail; dotted: exceeded by chance in 5 %%', \
                 most('lh_ramp/points.tsv', 'n'))
panels = 2
shared = 2
load 'figures/style.gp'
set xlabel 'density of a sphere (g/cm^3)'
set logscale xy
set xrange [0.2:10]
set xtics (0.25, 0.5, 1, 2, 4, 8)
set yrange [0.5:100]
piles = 'ramp ramp drop drop'
slips = 'truncated total truncated total'
names_of = '"gravity grows, spring cut" "gravity grows, spring as printed" "grains fall, spring cut" "grains fall, spring as printed"'
marks = '7 6 5 4'
colour = '1 1 2 2'
whole(k, y, many) = stringcolumn('slip') eq word(slips, k) && (column('n_least') >= 90) == many ? column(y) : NaN
do for [i=1:2] {
    y = word('chi2 left', i)
    eval panel(i, word('"(a) the angles as printed" "(b) less a common shift"', i))
    set ylabel 'χ^2'
    limit = i == 1 ? 11.07 : 9.49
    plot limit with lines ls guide notitle, \
         for [k=1:4] t('claims/'.word(piles, k).'.tsv') using (column('density')*(0.94 + 0.04*k)):(whole(k, y, 1)) with points ls int(word(colour, k)) pt int(word(marks, k)) title word(names_of, k), \
         for [k=1:4] t('claims/'.word(piles, k).'.tsv') using (column('density')*(0.94 + 0.04*k)):(whole(k, y, 0)) with points ls int(word(colour, k)) pt 2 notitle
}
