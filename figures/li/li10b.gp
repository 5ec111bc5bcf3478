# Liffman, Chan & Hughes 1992, figure 10(b): the weakest contact of each disk with another disk, drawn as figure 10(a).
# sweeps: pile
contact = 'weakest'
load 'figures/li/li10a.gp'
