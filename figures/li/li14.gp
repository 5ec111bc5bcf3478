# Liffman, Chan & Hughes 1992, figure 14: horizontal force on the base for four slopes, drawn as figure 13.
# sweeps: continuum pile
force = 'H'
heading = 'Horizontal force on the base for four slopes'
load 'figures/li/li13.gp'
