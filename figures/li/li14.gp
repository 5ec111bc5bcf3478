# Liffman, Chan & Hughes 1992, figure 14: horizontal force on the base for four slopes, drawn as figure 13.
# tables: continuum_30.tsv continuum_45.tsv continuum_50.tsv continuum_55.tsv pile_45_30_1e-4.tsv pile_45_45_1e-4.tsv
#    pile_45_50_1e-4.tsv pile_45_55_1e-4.tsv
force = 'H'
heading = 'Horizontal force on the base for four slopes'
load 'figures/li/li13.gp'
