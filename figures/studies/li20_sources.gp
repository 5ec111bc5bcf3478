# Dropped piles of six kinds, as figure 20(b) of Liffman, Chan & Hughes 1992: mean pressure on the base.
# sweeps: li20_broad li20_hard li20_own li20_point li20_sizes li20_soft
kinds = 'point/ own/ soft/ broad/ sizes/ hard/'
kind_names = '"contacts of the paper" "our contacts" "no hard collisions" "broad source, 30 {/:Italic d}" "radii ± 5 %" "contacts 4 × as hard"'
load 'figures/li/li20b.gp'
