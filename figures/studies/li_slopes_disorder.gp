# Effect of unequal disks on figures 14, 16 and 17 of Liffman, Chan & Hughes 1992, as li_slopes_wells draws that of wells;
# a = eps sigma. Stable states of the same random draws; bars: standard errors over piles. Steep piles of very unequal
# disks spread.
# sweeps: li_slopes_disorder
varied = 'disorder'
heading = 'Forces under piles of unequal disks'
what = 'disorder'
data = 'li_slopes_disorder/points.tsv'
lowest = 4e-7
highest = 2.5e-2
load 'figures/studies/li_slopes_wells.gp'
