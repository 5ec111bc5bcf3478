# Mean pressure on the base of dropped piles, point and wide sources on flat and rough bases, drawn as figure 20(b) of Liffman,
# Chan & Hughes 1992.
# sweeps: li20_history
kinds = 'history/flat_ history/flat_wide_ history/sizes_ history/rough_ history/rough_wide_ history/rough_sizes_'
kind_names = '"point source, flat base" "source 60 {/:Italic d}, flat base" "radii ± 5 %, flat base" "point source, rough base" "source 60 {/:Italic d}, rough base" "radii ± 10 %, rough base"'
load 'figures/li/li20b.gp'
