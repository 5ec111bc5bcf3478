# Energy of five elastic disks in a box, by the implicit scheme (24) and by Verlet; frequency of a disk on its spring.
# Time steps in contact times of two disks.
# tables: validation_implicit_energy.tsv validation_implicit_phase.tsv
set multiplot layout 1,2 margins 0.105,0.985,0.14,0.97 spacing 0.115
set tics font ',9'
set logscale xy
set format xy '10^{%T}'
set xlabel 'steps' font ',9'
set ylabel 'largest relative energy error so far' offset 1.8,0 font ',9'
set xrange [10:1e6]
set yrange [1e-16:1e3]
set key top left Left reverse maxrows 4 font ',7' samplen 1.2 width -3
set label 1 'Δ{/:Italic t} in contact times' at graph 0.06,0.79 font ',7'
e = t('validation_implicit_energy.tsv')
plot e using (column('step')):(column('verlet_0.1')) with lines lw 1.5 dt (6,3) lc 6 title 'Verlet, Δ{/:Italic t} = 0.1', \
     e using (column('step')):(column('verlet_0.01')) with lines lw 1.5 dt (6,3) lc 7 title 'Verlet, 0.01', \
     e using (column('step')):(column('loose_1')) with lines lw 1.5 dt (2,2) lc 4 title '(24), 1, to 10^{-9} {/:Italic r}', \
     1e-15*sqrt(x) with lines lc rgb '#888888' dt 3 title '10^{-15} √steps', \
     e using (column('step')):(column('implicit_10')) with lines lw 1.5 lc 5 title '(24), 10', \
     e using (column('step')):(column('implicit_1')) with lines lw 1.5 lc 3 title '(24), 1', \
     e using (column('step')):(column('implicit_0.1')) with lines lw 1.5 lc 2 title '(24), 0.1', \
     e using (column('step')):(column('implicit_0.01')) with lines lw 1.5 lc 1 title '(24), 0.01'
unset label 1
set xlabel '{/:Italic ω} Δ{/:Italic t}' font ',9'
set ylabel 'frequency of a disk on its spring / {/:Italic ω}' offset 1.8,0 font ',9'
unset logscale y
set format y '%g'
set xrange [0.02:50]
set yrange [0:1.6]
set key bottom left width 0 maxrows 3
p = t('validation_implicit_phase.tsv')
plot p using (column('omega_dt')):(column('omega_eff')) with points pt 6 ps 0.9 lc 3 title '(24), measured', \
     [0.02:35] 2.0/x*atan(0.5*x) with lines lc 3 title '2 atan({/:Italic ω} Δ{/:Italic t}/2)/({/:Italic ω} Δ{/:Italic t})', \
     [0.02:2] 2.0/x*asin(0.5*x) with lines lc 6 dt (6,3) title 'Verlet, 2 asin({/:Italic ω} Δ{/:Italic t}/2)/({/:Italic ω} Δ{/:Italic t})'
