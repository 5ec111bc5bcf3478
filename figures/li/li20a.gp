# Liffman, Chan & Hughes 1992, figure 20(a): a pile of disks dropped one at a time, coloured by the number of
# contacts; disks without six neighbours mark the faults. Disks that rolled out of the picture are not shown.
# tables: li20_point/pile_grains.tsv
width = 18.0
height = 7.6
load 'figures/style.gp'
grains = t('li20_point/pile_grains.tsv')
set size ratio -1
set xlabel '{/:Italic x / d}'
set ylabel '{/:Italic y / d}'
set xrange [-50:50]
set yrange [-0.5:30]
unset grid
set key above maxrows 1 font ',9'
colours = "#d55e00 #e69f00 #f0e442 #56b4e9 #d9d9d9"
names = '"2 contacts or fewer" "3" "4" "5" "6 or more"'
few(k) = k < 2 ? 2 : k > 6 ? 6 : k
plot for [k = 2:6] grains using (few(column('contacts')) == k ? column('x') : NaN):(column('y')):(column('r')) \
       with circles lw 0.4 fs solid 1.0 border lc rgb '#606060' fc rgb word(colours, k - 1) notitle, \
     for [k = 2:6] NaN with points pt 7 ps 1.2 lc rgb word(colours, k - 1) title word(names, k - 1)
