# Lee & Herrmann 1993, figure 1(c): 1600 grains, at rest after the avalanche, drawn as figure 1(a).
# sweeps: lh1
state = 'pile'
heading = 'Forces in the pile that is left after the avalanche'
x_end = 24.2
y_end = 7
across = 2
ratio = 7.3/24.6
load 'figures/lh/lh1a.gp'
