# Largest stable time step against damping: measured, theory, and the limit above which a scene is refused. Right: the
# largest step that the implicit scheme solves.
# tables: validation_stability.tsv validation_stability_implicit.tsv
width = 24.0
height = 9.0
load 'figures/style.gp'
# the rows of a system: equal masses, no shear springs
of(system, scheme) = sprintf("< awk -F'\t' '/^#/ { next } !n++ { print; next } $1 == \"%s\" && $2 == \"hertz\" && $3 == \"%s\" && $4 == 1e6 && $6 == 1 && $7 == 1 && $8 == 0' ", system, scheme).path('validation_stability.tsv').' | sort -g -k13,13'
stats t('validation_stability.tsv') using (column('margin')) nooutput name 'M'
systems = 'pair wall loaded packing'
titles = '"two grains between fixed ones" "grain between two walls" "grain on a wall under a load" "37 grains of a packing in a fixed ring"'
at(x) = x > 0 ? x : 0.012
set logscale xy
set xrange [0.01:12]
set yrange [3e-3:4]
set xlabel '{/:Italic γ}_n/{/:Italic ω}'
set xtics ('0' 0.012, '0.03' 0.03, '0.1' 0.1, '0.3' 0.3, '1' 1, '3' 3, '10' 10)
set multiplot
panel(l, r) = sprintf('set lmargin at screen %g; set rmargin at screen %g; set bmargin at screen 0.14; set tmargin at screen 0.9', l, r)
do for [scheme in 'verlet gear5'] {
    eval scheme eq 'verlet' ? panel(0.08, 0.36) : panel(0.38, 0.66)
    set title scheme eq 'verlet' ? 'velocity Verlet' : 'Gear, fifth order' font ',9'
    if (scheme eq 'verlet') {
        set ylabel '{/:Italic ω} d{/:Italic t}, {/:Italic ω}^2 = {/:Italic k}/{/:Italic m}_{eff} of a contact'
        set key bottom left Left reverse font ',7.5' samplen 2 spacing 1.15
        set label 1 sprintf('measured/limit in all %d cases: %.2f to %.2f', M_records, M_min, M_max) at graph 0.98, 0.96 right font ',7.5'
    } else {
        unset ylabel; unset label 1; set format y ''; unset key
    }
    plot for [i=1:4] of(word(systems, i), scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_measured')) with points pt (int(word('7 5 9 13', i))) ps 0.8 lc (int(word('2 3 4 6', i))) title word(titles, i), \
         for [i=1:4] of(word(systems, i), scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_theory')) with lines lc (int(word('2 3 4 6', i))) notitle, \
         NaN with lines lc 1 title 'lines: theory of the scheme', \
         of('packing', scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_limit')) with lines lw 1.5 dt 2 lc 1 title 'refused above (overlap known)'
}
eval panel(0.735, 0.99)
set title 'implicit: colliding elastic grains' font ',9'
set format y '%g'
set xrange [7e-5:1.4e-2]
set yrange [2:2000]
set xtics ('10^{-4}' 1e-4, '10^{-3}' 1e-3, '10^{-2}' 1e-2)
set xlabel 'overlap of an impact / {/:Italic r}'
set ylabel 'largest solvable d{/:Italic t} / contact time'
set key top right Left reverse font ',7.5' samplen 2 spacing 1.15
solved(solver, tolerance) = sprintf("< awk -F'\t' '/^solver\t/ { print } $1 == \"%s\" && $2 %s 1e-14' ", solver, tolerance).path('validation_stability_implicit.tsv').' | sort -g -k3,3'
plot solved('direct', '<') using (column('depth')):(column('half_skin')) with lines lw 1.5 dt 2 lc 1 title 'displacement at impact speed = skin/2', \
     solved('direct', '<') using (column('depth')):(column('dt_over_contact_time')) with linespoints pt 7 ps 0.8 lc 2 title 'direct solver, tolerance 10^{-15}', \
     solved('sor', '>') using (column('depth')):(column('dt_over_contact_time')) with linespoints pt 9 ps 0.8 lc 4 title 'SOR, tolerance 10^{-12}', \
     solved('sor', '<') using (column('depth')):(column('dt_over_contact_time')) with linespoints pt 5 ps 0.8 lc 3 title 'SOR, tolerance 10^{-15}'
unset multiplot
