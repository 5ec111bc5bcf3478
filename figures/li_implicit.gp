# Energy of five disks that bounce in a box without loss, by the implicit scheme (24) and by Verlet; and the
# frequency of a disk on its spring. Time steps in contact times of two disks.
width = 17.0
set multiplot layout 1,2 margins 0.085,0.985,0.15,0.93 spacing 0.1
set logscale xy
set format xy '10^{%T}'
set xlabel 'steps'
set ylabel 'largest error in energy, relative' offset 0.8,0
set yrange [1e-16:1e3]
set key top left Left reverse maxrows 4 font ',7' samplen 1.2
e = t('validation_implicit_energy.tsv')
plot e using (column('step')):(column('verlet_0.01')) with lines lw 1.5 dt 2 lc 7 title 'Verlet, Δ{/:Italic t} = 0.01', \
     e using (column('step')):(column('verlet_0.1')) with lines lw 1.5 dt 2 lc 6 title 'Verlet, 0.1', \
     e using (column('step')):(column('loose_1')) with lines lw 1.5 dt 4 lc 4 title '(24), 1, tolerance 10^{-9}', \
     e using (column('step')):(column('implicit_0.01')) with lines lw 1.5 lc 1 title '(24), 0.01', \
     e using (column('step')):(column('implicit_0.1')) with lines lw 1.5 lc 2 title '(24), 0.1', \
     e using (column('step')):(column('implicit_1')) with lines lw 1.5 lc 3 title '(24), 1', \
     e using (column('step')):(column('implicit_10')) with lines lw 1.5 lc 5 title '(24), 10', \
     [10:1e6] 1e-16*sqrt(x) with lines lc rgb '#888888' dt 3 title '10^{-16} (steps)^{1/2}'
set xlabel '{/:Italic ω} Δ{/:Italic t}'
set ylabel 'frequency / {/:Italic ω}' offset 1.2,0
unset logscale y
set format y '%g'
set yrange [0:1.6]
set key bottom left
p = t('validation_implicit_phase.tsv')
plot p using (column('omega_dt')):(column('omega_eff')) with points pt 6 ps 0.9 lc 3 title '(24), measured', \
     [0.03:35] 2.0/x*atan(0.5*x) with lines lc 3 title '2 atan({/:Italic ω}Δ{/:Italic t}/2)/Δ{/:Italic t}', \
     [0.03:2] 2.0/x*asin(0.5*x) with lines lc 6 dt 2 title 'Verlet, 2 asin({/:Italic ω}Δ{/:Italic t}/2)/Δ{/:Italic t}'
