# Liffman, Chan & Hughes 1992, figure 13: normal force on the base for four slopes, 45 disks in the base: soft disks
# in equilibrium at eps = 1e-4 (spring wells of K_s), forces of diagonal contacts alone in the same piles, and the
# continuum (54)-(59); soft disks less the continuum. Unit: largest value of the soft disks. figures/li/li14.gp draws by this
# file. A page shows the first and the last slope.
# sweeps: continuum pile
if (!exists('force')) { force = 'N'; heading = 'Normal force on the base for four slopes' }
slopes = terminal eq 'shown' ? '30 55' : '30 45 50 55'
n = words(slopes)
panels = n + 2
shared = 1
load 'figures/style.gp'
soft(k) = 'pile/45_'.word(slopes, k).'_1e-4.tsv'
set xlabel '{/:Italic x / B}'
set ylabel force eq 'N' ? '{/:Italic N} / max {/:Italic N}' : '{/:Italic H} / max |{/:Italic H}|'
set xrange [0:1]
set yrange [force eq 'N' ? 0 : -1.5:force eq 'N' ? 1.2 : 1.5]
f = force.'/(chi*g*B)'
do for [k=1:n] {
    eval panel(k, sprintf('(%s) α = %s°, %s disks', word('a b c d', k), word(slopes, k), note(soft(k), 'n_disks')))
    B = real(note(soft(k), 'B'))
    stats t(soft(k)) using (abs(column(f))) nooutput name 'S'
    plot t('continuum/'.word(slopes, k).'.tsv') using (column('x/B')):(column(f)/S_max) with lines ls theory title 'continuum', \
         t(soft(k)) using (column('x/B')):(column(force.'_diagonals/mg')/S_max/B) with points ls 2 pt 2 title 'diagonal contacts alone', \
         t(soft(k)) using (column('x/B')):(column(f)/S_max) with points ls ours title 'soft disks'
}
set ylabel 'soft disks less continuum'
set yrange [-0.3:0.3]
do for [k=1:2] {
    j = k == 1 ? 1 : n
    eval panel(n + k, sprintf('(%s) α = %s°', word('a b c d e f', n + k), word(slopes, j)))
    stats t(soft(j)) using (abs(column(f))) nooutput name 'S'
    plot less(soft(j), 'continuum/'.word(slopes, j).'.tsv', f) using (column('x')):(column('less')/S_max) with points ls ours notitle, 0 with lines ls theory notitle
}
