# The onset of motion: contacts that slide and grains that move as a pile is tilted, and what predicts its tilting angle.
# tables: lh_onset.tsv lh_onset_predict.tsv lh_onset_model.tsv
heading = 'The onset of motion: what slides, what moves, and what predicts it'
remark = sprintf('%d piles at each friction; (a) to (c) {/:Italic μ} = 0.2; bars: standard error, in (c) 95 %% interval, in (d) error of a pile', most('lh_onset.tsv', 'theta_r3_deg_n'))
panels = 4
legend = 4
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
plot for [q=0:4] for [k=1:3] t('lh_onset.tsv') using (0.25*q):(at(0.2, c(limit(k, q).'mean'))):(c(limit(k, q).'se')) \
       with yerrorbars ls k title (q == 0 ? word('"with the floor" "with the wall" "between grains"', k) : '')
eval panel(2, '(b) grains that have moved at {/:Italic θ}_T')
set xlabel 'distance from the wall {/:Italic x/W}'
set ylabel 'share moved by 0.1 {/:Italic d}'
set xrange [0:1]
set yrange [0:0.4]
layer(k) = word('surface inside floor', k)
zone(k, q) = sprintf('moved_%s_%d_', layer(k), q)
plot for [q=1:4] for [k=1:3] t('lh_onset.tsv') using (0.25*q - 0.125):(at(0.2, c(zone(k, q).'mean'))):(c(zone(k, q).'se')) \
       with yerrorbars ls 4 - k title (q == 1 ? word('"surface, 1.5 {/:Italic d} deep" "inside" "on the floor"', k) : '')
eval panel(3, '(c) correlation with {/:Italic θ}_T of the same pile')
set xlabel 'correlation'
unset ylabel
set xrange [-0.7:0.7]
set yrange [0:9]
names = 'theta_t_theory_deg theta_r3_deg contact_number fabric limit_probe floor_friction_0 bulk_friction_0 all'
set ytics ('(4)' 8, '{/:Italic θ}_R' 7, '{/:Italic Z}' 6, 'fabric' 5, 'sliding' 4, 'floor' 3, 'inside' 2, 'all' 1)
of(name, x) = strcol('predictor') eq name ? at(0.2, x) : NaN
plot for [k=1:8] t('lh_onset_predict.tsv') using (of(word(names, k), c('correlation'))):(9 - k):(c('correlation_lo')):(c('correlation_hi')) with xerrorbars ls ours notitle, \
     '+' using (0):(9*($1 + 0.7)/1.4) with lines ls guide notitle
set ytics autofreq
eval panel(4, '(d) tilting angle')
set xlabel 'friction coefficient {/:Italic μ}'
set ylabel '{/:Italic θ}_T (degrees)'
set xrange [0.08:0.32]
set yrange [0:10]
by(name, x) = strcol('predictor') eq name ? x : NaN
plot t('lh_onset_model.tsv') using (c('mu') + 0.002):(by('theta_t_theory_deg', c('predicted'))):(c('rms')) with yerrorbars ls 12 title '(4) balanced', \
     '' using (c('mu') - 0.002):(by('bulk_friction_0', c('predicted'))):(c('rms')) with yerrorbars ls 11 title 'line through the friction inside', \
     '' using (c('mu') + 0.006):(by('mu', c('predicted'))):(c('rms')) with yerrorbars ls 13 title 'line in {/:Italic μ} alone', \
     '' using (c('mu')):(by('bulk_friction_0', c('measured'))):(c('measured_se')) with yerrorbars ls ours title 'measured'
