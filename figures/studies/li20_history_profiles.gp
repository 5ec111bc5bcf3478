# Mean pressure on the base of dropped piles, point and wide sources on flat and rough bases, drawn as figure 20(b) of Liffman,
# Chan & Hughes 1992.
# tables: li20_history_flat_dip.tsv li20_history_flat_profile.tsv li20_history_flat_wide_dip.tsv
#    li20_history_flat_wide_profile.tsv li20_history_sizes_dip.tsv li20_history_sizes_profile.tsv li20_history_rough_dip.tsv
#    li20_history_rough_profile.tsv li20_history_rough_wide_dip.tsv li20_history_rough_wide_profile.tsv
#    li20_history_rough_sizes_dip.tsv li20_history_rough_sizes_profile.tsv
kinds = 'history_flat history_flat_wide history_sizes history_rough history_rough_wide history_rough_sizes'
kind_names = '"point source, flat base" "source 60 {/:Italic d}, flat base" "radii ± 5 %, flat base" "point source, rough base" "source 60 {/:Italic d}, rough base" "radii ± 10 %, rough base"'
load 'figures/li/li20b.gp'
