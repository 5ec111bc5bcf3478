# Lee & Herrmann 1993, section 4: what the five printed angles say of the mass of a grain, the floor and the shear spring.
# sweeps: claims lh_choices
heading = 'The five printed angles, for each choice'
remark = sprintf('%d piles a setting; filled: the spring of (2b) cut at the Coulomb limit; open: as printed; pale: up to six of ten piles fail at {/:Italic k}_n = 10^4, and all at densities of 7.5 (a disk of 1 g/cm^2) and 25; dotted: exceeded by chance in 5 %% of cases', \
                 most('lh_choices/points.tsv', 'theta_r3_deg_n'))
panels = 2
shared = 3
load 'figures/style.gp'
floors = 'extends ends absorbs'
names_of = '"the floor extends" "it ends at the opening" "it absorbs grains"'
chosen(f, s) = stringcolumn('floor') eq word(floors, f) && stringcolumn('slip') eq s
few(y) = column('n_least') < 90 ? y : NaN
x(f) = column('density')*(1 + 0.06*(f - 2))
set xlabel 'density of a sphere (g/cm^3)'
set logscale xy
set xrange [0.18:4]
set xtics (0.25, 1, 2.5)
set yrange [0.5:300]
do for [k=1:2] {
    y = word('chi2 left', k)
    eval panel(k, word('"(a) the angles as printed" "(b) less a common shift"', k))
    set ylabel 'χ^2'
    limit = k == 1 ? 11.07 : 9.49
    plot limit with lines ls guide notitle, \
         for [f=1:3] t('claims/choices.tsv') using (x(f)):(chosen(f, 'truncated') ? column(y) : NaN) with points ls f title word(names_of, f), \
         for [f=1:3] '' using (x(f)):(chosen(f, 'total') ? column(y) : NaN) with points ls f pt int(word('6 4 8', f)) notitle, \
         for [f=1:3] '' using (x(f)):(few(1) == 1 && stringcolumn('floor') eq word(floors, f) ? column(y) : NaN) with points pt 7 ps 1.1 lc rgb '#80ffffff' notitle
}
