# Dropped piles of four kinds, as figure 20(b) of Liffman, Chan & Hughes 1992: mean pressure on the base.
# tables: continuum_30.tsv li20_broad_dip.tsv li20_broad_dip_raw.tsv li20_broad_profile.tsv li20_hard_dip.tsv
#    li20_hard_dip_raw.tsv li20_hard_profile.tsv li20_point_dip.tsv li20_point_dip_raw.tsv li20_point_profile.tsv
#    li20_sizes_dip.tsv li20_sizes_dip_raw.tsv li20_sizes_profile.tsv
kinds = 'point broad sizes hard'
kind_names = '"point source" "broad source, 30 {/:Italic d}" "radii ± 5 %" "contacts 4 × as hard"'
load 'figures/li/li20b.gp'
