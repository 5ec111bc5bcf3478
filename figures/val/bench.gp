# Speed: particle-steps per second on one core, with LAMMPS and LIGGGHTS, from the same initial positions.
# tables: bench_peers.tsv
data = t('bench_peers.tsv')
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 border
set boxwidth 0.9
set yrange [0:*]
set offsets 0, 0, graph 0.15, 0
set xtics scale 0
set xtics offset 0, 0
set grid noxtics
rates = "< awk -F'\t' '/^#/ { next } !n++ { print; next } $1 != \"sample\"' ".path('bench_peers.tsv')
label(state, n) = sprintf("%s\n%s", int(n) % 1000 == 0 ? sprintf('%d 000', int(n)/1000) : sprintf('%d', int(n)), state eq 'settled' ? 'at rest' : 'flowing')
times(r, lo, hi) = sprintf("×%.1f (%.1f–%.1f)", r, lo, hi)
sample(col, format) = system("awk -F'\t' '/^#/ { next } !n { n = split($0, a, \"\t\"); for (i = 1; i <= n; i++) c[a[i]] = i; next } $1 == \"sample\" { printf \"".format."\", $c[\"".col."\"] }' ".path('bench_peers.tsv'))
version(peer) = system("sed -n 's/^# ".peer.": //p' ".path('bench_peers.tsv'))
# the installed programs
programs = 'repose '.system("sed -nE '/not installed/d; s/^# (lammps|liggghts): .*/\\1/p' ".path('bench_peers.tsv'))
n = words(programs)
program(i) = word(programs, i)
name(i) = i == 1 ? 'repose' : program(i) eq 'lammps' ? 'LAMMPS' : 'LIGGGHTS'
colour(i) = i == 1 ? 0x000000 : program(i) eq 'lammps' ? 0x0072b2 : 0x009e73
bar(i) = (i - 0.5*(n + 1))/(n + 1)
faster(i) = i == 1 ? '' : times(column(program(i).'_ratio'), column(program(i).'_min'), column(program(i).'_max'))
samples = 'A whole sample of 400 grains: repose '.sample('repose', '%.2f').' s'
do for [i=2:n] { samples = samples.', '.name(i).' '.sample(program(i), '%.1f').' s, ×'.sample(program(i).'_ratio', '%.1f') }
heading = 'Speed on one core, from the same initial positions'
remark = 'over the bars: rate of repose over the rate of the program, median of pairs (smallest–largest). '.samples
across = 2
ratio = 0.4
legend = 3
load 'figures/style.gp'
set ylabel '10^6 particle-steps per second'
set xtics offset 0, 0 scale 0
set grid noxtics
plot for [i=1:n] rates using program(i):xticlabels(label(strcol('state'), column('grains'))) \
        title name(i).' '.version(program(i)) lc rgb colour(i), \
     for [i=1:n] rates using ($0 + bar(i)):program(i):(faster(i)) with labels rotate by 90 left offset 0, 0.4 notitle
