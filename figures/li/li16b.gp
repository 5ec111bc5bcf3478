# Liffman, Chan & Hughes 1992, figure 16(b): the weakest contact of each disk with another disk, drawn as figure 16(a).
# sweeps: pile
contact = 'weakest'
load 'figures/li/li16a.gp'
