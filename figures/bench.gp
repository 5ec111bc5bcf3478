# Speed: particle-steps a second on one core against LAMMPS, on the same scene and start.
width = 16.0
load 'figures/style.gp'
data = t('bench_peers.tsv')
set style data histograms
set style histogram clustered gap 1
set style fill solid 0.8 border
set boxwidth 0.9
set ylabel '10^6 particle-steps a second of processor time'
set yrange [0:*]
set offsets 0, 0, graph 0.15, 0
set xtics scale 0
set bmargin 5.5
set grid noxtics
set key top right
rates = "< awk -F'\t' '/^#/ { h = substr($0, 3); next } h != \"\" { print h; h = \"\" } $1 != \"sample\"' ".T.'bench_peers.tsv'
label(state, n) = sprintf("%s\n%s", int(n) % 1000 == 0 ? sprintf('%d 000', int(n)/1000) : sprintf('%d', int(n)), state eq 'settled' ? 'at rest' : 'flowing')
times(r, lo, hi) = sprintf("×%.1f\n(%.1f–%.1f)", r, lo, hi)
sample(col) = system("awk -F'\t' '/^#/ { h = substr($0, 3); next } !n { n = split(h, a, \"\t\"); for (i = 1; i <= n; i++) c[a[i]] = i } $1 == \"sample\" { printf \"%.2f\", $c[\"".col."\"] }' ".T.'bench_peers.tsv')
set xlabel 'grains; over the bars the ratio, median of pairs (least–largest). A whole sample of 400 grains: '. \
           sample('repose').' s against '.sample('lammps').' s, ×'.sample('ratio') font ',8' offset 0,-1
plot rates using 'repose':xticlabels(label(strcol('state'), column('grains'))) title 'repose' lc 7, \
     '' using 'lammps' title 'LAMMPS '.system("sed -n 's/^# lammps: //p' ".T.'bench_peers.tsv') lc 3, \
     '' using ($0 - 0.17):'repose':(times(column('ratio'), column('ratio_min'), column('ratio_max'))) \
        with labels offset 0, 1.2 font ',8' notitle
