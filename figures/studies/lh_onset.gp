# The onset of motion: contacts that slide and grains that move as a pile is tilted, and what goes with its tilting angle.
# sweeps: lh_onset
heading = 'The onset of motion: what slides, what moves, and what goes with it'
remark = sprintf('%d piles at each friction; (a) to (c) {/:Italic μ} = 0.2; bars: standard error, in (c) 95 %% interval', most('lh_onset/points.tsv', 'theta_r3_deg_n'))
panels = 3
legend = 3
sample = 0
load 'figures/style.gp'
c(name) = column(name)
at(mu, x) = c('mu') == mu ? x : NaN
eval panel(1, '(a) contacts that slide')
set xlabel 'tilt over {/:Italic θ}_T'
set ylabel 'share at the limit of friction'
set xrange [-0.05:1.05]
set yrange [0:0.8]
class(k) = word('floor wall inside', k)
limit(k, q) = sprintf('limit_%s_%d_', class(k), q)
plot for [q=0:4] for [k=1:3] t('lh_onset/points.tsv') using (0.25*q):(at(0.2, c(limit(k, q).'mean'))):(c(limit(k, q).'se')) \
       with yerrorbars ls k title (q == 0 ? word('"with the floor" "with the wall" "between grains"', k) : '')
eval panel(2, '(b) grains that have moved at {/:Italic θ}_T')
set xlabel 'distance from the wall {/:Italic x/W}'
set ylabel 'share moved by 0.1 {/:Italic d}'
set xrange [0:1]
set yrange [0:0.4]
layer(k) = word('surface inside floor', k)
zone(k, q) = sprintf('moved_%s_%d_', layer(k), q)
plot for [q=1:4] for [k=1:3] t('lh_onset/points.tsv') using (0.25*q - 0.125):(at(0.2, c(zone(k, q).'mean'))):(c(zone(k, q).'se')) \
       with yerrorbars ls 4 - k title (q == 1 ? word('"surface, 1.5 {/:Italic d} deep" "inside" "on the floor"', k) : '')
eval panel(3, '(c) correlation with {/:Italic θ}_T of the same pile')
set xlabel 'correlation'
unset ylabel
set xrange [-0.7:0.7]
set yrange [0:8]
names = 'theta_t_theory_deg theta_r3_deg contact_number fabric limit_probe floor_friction_0 bulk_friction_0'
set ytics ('(4)' 7, '{/:Italic θ}_R' 6, '{/:Italic Z}' 5, 'fabric' 4, 'sliding' 3, 'floor' 2, 'inside' 1)
of(name, x) = strcol('quantity') eq name ? at(0.2, x) : NaN
plot for [k=1:7] t('lh_onset/correlation.tsv') using (of(word(names, k), c('correlation'))):(8 - k):(c('correlation_lo')):(c('correlation_hi')) with xerrorbars ls ours notitle, \
     '+' using (0):(8*($1 + 0.7)/1.4) with lines ls guide notitle
