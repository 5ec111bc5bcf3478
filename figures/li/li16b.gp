# Liffman, Chan & Hughes 1992, figure 16(b): the weakest contact of each disk with another disk, drawn as figure 16(a).
# tables: pile_45_30_1e-4/contacts.tsv pile_45_30_1e-4/disks.tsv
contact = 'weakest'
load 'figures/li/li16a.gp'
