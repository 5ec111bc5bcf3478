# Effect of gaps between the disks of a row on figures 14, 16 and 17 of Liffman, Chan & Hughes 1992, as li_slopes_wells
# draws that of wells; a = eps sigma.
# sweeps: li_slopes_gaps
varied = 'gap'
heading = 'Forces under piles against gaps in the rows'
what = 'gap / σ'
data = 'li_slopes_gaps/points.tsv'
lowest = 4e-6
highest = 2.5e-2
load 'figures/studies/li_slopes_wells.gp'
