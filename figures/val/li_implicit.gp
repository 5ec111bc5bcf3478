# Energy of five elastic disks in a box, by the implicit scheme (24) and by Verlet; frequency of a disk on its spring.
# Time steps in contact times of two disks.
# sweeps: implicit
heading = 'Implicit scheme (24) and Verlet: energy of five elastic disks, and frequency of one'
remark = 'Δ{/:Italic t} in contact times'
panels = 2
legend = 8
load 'figures/style.gp'
eval panel(1, '(a) energy')
set logscale xy
set format xy '10^{%T}'
set ylabel offset powers
set xlabel 'steps'
set ylabel 'largest relative error so far'
set xrange [10:1e6]
set yrange [1e-16:1e3]
energy = t('implicit/energy.tsv')
plot 1e-15*sqrt(x) with lines ls guide title '10^{-15} √steps', \
     for [k=1:2] energy using (column('step')):(column('verlet_'.word('0.1 0.01', k))) with lines lw 1.5 dt 2 lc rgb word('#e69f00 #d55e00', k) title 'Verlet, Δ{/:Italic t} = '.word('0.1 0.01', k), \
     energy using (column('step')):(column('loose_1')) with lines lw 1.5 dt 3 lc rgb '#cc79a7' title '(24), 1, to 10^{-9} {/:Italic r}', \
     for [k=1:4] energy using (column('step')):(column('implicit_'.word('10 1 0.1 0.01', k))) with lines lw 1.5 lc rgb word('#56b4e9 #0072b2 #009e73 #000000', k) title '(24), '.word('10 1 0.1 0.01', k)
eval panel(2, '(b) frequency of a disk on its spring')
set xlabel '{/:Italic ω} Δ{/:Italic t}'
set ylabel 'frequency / {/:Italic ω}'
unset logscale y
set format y '%g'
set ylabel offset aside
set xrange [0.02:50]
set yrange [0:1.6]
plot within(0.02, 35, x, 2.0/x*atan(0.5*x)) with lines ls 11 title '2 atan({/:Italic ω} Δ{/:Italic t}/2)/({/:Italic ω} Δ{/:Italic t})', \
     within(0.02, 2, x, 2.0/x*asin(0.5*x)) with lines ls 12 title 'Verlet, 2 asin({/:Italic ω} Δ{/:Italic t}/2)/({/:Italic ω} Δ{/:Italic t})', \
     t('implicit/phase.tsv') using (column('omega_dt')):(column('omega_eff')) with points ls ours title '(24), measured'
