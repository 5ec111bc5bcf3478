# Liffman, Chan & Hughes 1992, figure 20(a): a pile of disks dropped one at a time, coloured by the number of
# contacts; disks without six neighbours mark the faults. Disks that rolled out of the picture are not shown.
# sweeps: li20_point
heading = 'Contacts of dropped disks: fewer than six mark faults'
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
names_of = '"≤ 2 contacts" "3" "4" "5" "≥ 6"'
few(k) = k < 2 ? 2 : k > 6 ? 6 : k
plot for [k=2:6] t('li20_point/row_0/pile_grains.tsv') using (few(column('contacts')) == k ? column('x') : NaN):(column('y')):(column('r')) \
       with circles lw 0.4 fs solid 1.0 border lc rgb '#606060' fc rgb word(colours, k - 1) notitle, \
     for [k=2:6] keyentry with points pt 7 ps 1.2 lc rgb word(colours, k - 1) title word(names_of, k - 1)
