# Liffman, Chan & Hughes 1992, figure 20(a): a pile of disks dropped one at a time, coloured by the number of neighbours
# nearer than 1.1 d: fewer than six mark faults, and the surface. Contacts would not: those within rows are open in most of
# the sound lattice. Disks that rolled out of the picture are not shown.
# sweeps: li20_point
heading = 'Neighbours of dropped disks: fewer than six mark faults and the surface'
across = 2
ratio = 30.5/100
shared = 1
load 'figures/style.gp'
set size ratio -1
set xlabel '{/:Italic x / d}'
set ylabel '{/:Italic y / d}'
set xrange [-50:50]
set yrange [-0.5:30]
unset grid
colours = '#d55e00 #e69f00 #f0e442 #56b4e9 #eeeeee'
names_of = '"≤ 2 neighbours" "3" "4" "5" "≥ 6"'
few(k) = k < 2 ? 2 : k > 6 ? 6 : k
near = '< '.rows_do('li20_point/row_0/pile_grains.tsv', '', '{ x[++k] = $c["x"]; y[k] = $c["y"] } END { print "x\ty\tneighbours"; for (i = 1; i <= k; i++) { m = 0; '.\
    'for (j = 1; j <= k; j++) m += i != j && (x[i] - x[j])^2 + (y[i] - y[j])^2 < 1.21; print x[i] "\t" y[i] "\t" m } }')
plot for [k=2:6] near using (few(column('neighbours')) == k ? column('x') : NaN):(column('y')):(0.5) \
       with circles lw 0.4 fs solid 1.0 border lc rgb '#606060' fc rgb word(colours, k - 1) notitle, \
     for [k=2:6] keyentry with points pt 7 ps 1.2 lc rgb word(colours, k - 1) title word(names_of, k - 1)
