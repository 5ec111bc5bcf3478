# Liffman, Chan & Hughes 1992, figure 10(b): the weakest contact of each disk with another disk, drawn as figure 10(a).
# tables: pile_45_60_1e-4/contacts.tsv pile_45_60_1e-4/disks.tsv
contact = 'weakest'
load 'figures/li/li10a.gp'
