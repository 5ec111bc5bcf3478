# Speed: particle-steps per second on one core, with LAMMPS and LIGGGHTS, from the same initial positions.
# sweeps: bench
data = t('bench/peers.tsv')
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 border
set boxwidth 0.9
set yrange [0:*]
set offsets 0, 0, graph 0.25, 0
# states at rest and flowing of scenes, "a|b"
rates(scenes) = '< '.rows_do('bench/peers.tsv', 'print; ', '$c["state"] != "sample" && $c["scene"] ~ /^('.scenes.')$/')
count(n) = int(n) % 1000 == 0 ? sprintf('%d 000', int(n)/1000) : sprintf('%d', int(n))
label(scene, state, n) = count(n)."\n".(state eq 'settled' ? 'at rest' : 'flowing').(scene eq 'sizes' ? ', 1:10' : '')
times(r, lo, hi) = sprintf("×%.1f (%.1f–%.1f)", r, lo, hi)
sample(col, format) = sprintf(format, real(pick('bench/peers.tsv', 'state', 'sample', col)))
version(peer) = system("sed -n 's/^# ".peer.": //p' ".path('bench/peers.tsv'))
# the installed programs
programs = 'repose '.system("sed -nE '/not installed/d; s/^# (lammps|liggghts): .*/\\1/p' ".path('bench/peers.tsv'))
n = words(programs)
program(i) = word(programs, i)
name(i) = i == 1 ? 'repose' : program(i) eq 'lammps' ? 'LAMMPS' : 'LIGGGHTS'
colour(i) = i == 1 ? 0x000000 : program(i) eq 'lammps' ? 0x0072b2 : 0x009e73
bar(i) = (i - 0.5*(n + 1))/(n + 1)
# a program that takes no part in a scene has nan
faster(i) = i == 1 || !(column(program(i).'_ratio') > 0) ? '' : times(column(program(i).'_ratio'), column(program(i).'_min'), column(program(i).'_max'))
samples = 'A whole sample of 400 grains: repose '.sample('repose', '%.2f').' s'
do for [i=2:n] { samples = samples.', '.name(i).' '.sample(program(i), '%.1f').' s, ×'.sample(program(i).'_ratio', '%.1f') }
heading = 'Speed on one core, from the same initial positions'
remark = 'over the bars: rate of repose over the rate of the program, median of rounds (smallest–largest). '.samples
panels = 3
across = 2
ratio = 0.3
shared = 3
load 'figures/style.gp'
set ylabel '10^6 particle-steps per second'
set xtics offset 0, 0 scale 0
set grid noxtics
draw = 'plot for [i=1:n] rates(scenes) using program(i):xticlabels(label(strcol("scene"), strcol("state"), column("grains"))) title name(i)." ".version(program(i)) lc rgb colour(i), for [i=1:n] rates(scenes) using ($0 + bar(i)):program(i):(faster(i)) with labels rotate by 90 left offset 0, 0.4 notitle'
scenes = 'box|sizes'
eval panel(1, '(a) no rotation; 1:10: range of radii')
eval draw
scenes = 'rotation'
eval panel(2, '(b) rotation')
eval draw
scenes = 'rolling'
eval panel(3, '(c) rotation and rolling resistance')
eval draw
