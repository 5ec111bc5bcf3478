# Largest stable time step against damping: measured, theory, and the limit above which a scene is refused. (c): the
# largest step that the implicit scheme solves.
# sweeps: stability
heading = 'Largest time step that is stable (a, b) or solvable (c)'
remark = 'points: measured; lines of the same colour: theory of the scheme; {/:Italic ω}^2 = {/:Italic k}/{/:Italic m}_{eff} of a contact'
panels = 3
legend = 5
load 'figures/style.gp'
# the rows of a system: equal masses, no shear springs
of(system, scheme) = sprintf("< awk -F'\t' '/^#/ { next } !n++ { print; next } $1 == \"%s\" && $2 == \"hertz\" && $3 == \"%s\" && $4 == 1e6 && $6 == 1 && $7 == 1 && $8 == 0' ", system, scheme).path('stability/stability.tsv').' | sort -g -k13,13'
stats t('stability/stability.tsv') using (column('margin')) nooutput name 'M'
systems = 'pair wall loaded packing'
titles = '"two grains between fixed ones" "grain between two walls" "grain on a wall under a load" "37 grains of a packing in a fixed ring"'
at(x) = x > 0 ? x : 0.012
set logscale xy
set xrange [0.01:12]
set yrange [3e-3:4]
set xlabel '{/:Italic γ}_n/{/:Italic ω}'
set xtics ('0' 0.012, '0.03' 0.03, '0.1' 0.1, '0.3' 0.3, '1' 1, '3' 3, '10' 10)
set ylabel 'largest stable {/:Italic ω} d{/:Italic t}'
do for [k=1:2] {
    scheme = word('verlet gear5', k)
    eval panel(k, k == 1 ? sprintf('(a) Verlet; %d cases: %.2f to %.2f times limit', M_records, M_min, M_max) : '(b) Gear, fifth order')
    plot for [i=1:4] of(word(systems, i), scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_theory')) with lines ls i notitle, \
         of('packing', scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_limit')) with lines ls theory title 'refused above (overlap known)', \
         for [i=1:4] of(word(systems, i), scheme) using (at(column('gamma_over_omega'))):(column('omega_dt_measured')) with points ls i title word(titles, i)
}
eval panel(3, '(c) implicit: colliding elastic grains')
set format y '%g'
set xrange [7e-5:1.4e-2]
set yrange [2:2000]
set xtics ('10^{-4}' 1e-4, '10^{-3}' 1e-3, '10^{-2}' 1e-2)
set xlabel 'overlap of an impact / {/:Italic r}'
set ylabel 'solvable d{/:Italic t} / contact time'
solved(solver, tolerance) = sprintf("< awk -F'\t' '/^solver\t/ { print } $1 == \"%s\" && $2 %s 1e-14' ", solver, tolerance).path('stability/implicit.tsv').' | sort -g -k3,3'
plot solved('direct', '<') using (column('depth')):(column('half_skin')) with lines ls theory title 'displacement at impact speed = skin/2', \
     solved('direct', '<') using (column('depth')):(column('dt_over_contact_time')) with linespoints ls 1 title 'direct solver, tolerance 10^{-15}', \
     solved('sor', '>') using (column('depth')):(column('dt_over_contact_time')) with linespoints ls 2 title 'SOR, tolerance 10^{-12}', \
     solved('sor', '<') using (column('depth')):(column('dt_over_contact_time')) with linespoints ls 3 title 'SOR, tolerance 10^{-15}'
