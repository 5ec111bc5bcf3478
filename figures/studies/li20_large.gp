# Mean pressure on a rough base under dropped piles of 968 and of 10 000 disks, drawn as figure 20(b) of Liffman, Chan & Hughes
# 1992.
# tables: li20_history_rough_dip.tsv li20_history_rough_profile.tsv li20_large_dip.tsv li20_large_profile.tsv
#    li20_history_rough_wide_dip.tsv li20_history_rough_wide_profile.tsv li20_large_wide_dip.tsv li20_large_wide_profile.tsv
kinds = 'history_rough large history_rough_wide large_wide'
kind_names = '"point source, 968 disks" "point source, 10 000 disks" "source 60 {/:Italic d}, 968 disks" "source 193 {/:Italic d}, 10 000 disks"'
made = 'on disks glued 1.5 {/:Italic d} apart, softness 2 × 10^{-3} (968 disks) and 6.22 × 10^{-4} (10 000)'
load 'figures/li/li20b.gp'
