# Dropped piles of six kinds, as figure 20(b) of Liffman, Chan & Hughes 1992: mean pressure on the base.
# tables: li20_broad_dip.tsv li20_broad_profile.tsv li20_hard_dip.tsv li20_hard_profile.tsv li20_paper_dip.tsv
#    li20_paper_profile.tsv li20_point_dip.tsv li20_point_profile.tsv li20_sizes_dip.tsv li20_sizes_profile.tsv
#    li20_soft_dip.tsv li20_soft_profile.tsv
kinds = 'point paper soft broad sizes hard'
kind_names = '"point source" "contacts and ε of the paper" "no hard collisions" "broad source, 30 {/:Italic d}" "radii ± 5 %" "contacts 4 × as hard"'
load 'figures/li/li20b.gp'
