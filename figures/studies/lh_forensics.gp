# Choices that Lee & Herrmann 1993 leave open, given their numbers: posterior over prior of three of them, and predicted
# against published angles.
# tables: lh_forensics_posterior_density.tsv lh_forensics_posterior_numbers.tsv
heading = 'Open choices inferred from published angles'
remark = 'line at 1: no information; bars: published ± and standard deviation of the prediction'
panels = 4
legend = 3
load 'figures/style.gp'
density = 'lh_forensics_posterior_density.tsv'
chosen(name) = rows(density, 'choice', name)
array group[3] = ['{/:Italic k}_n {/:Italic d}^{1.5}/{/:Italic mg}', '{/:Italic γ}_n ({/:Italic d}/{/:Italic g})^{1/2}', '{/:Italic μ} of the floor over {/:Italic μ}']
array least[3] = [2e3, 3, 0.5]
array largest[3] = [4e5, 50, 3]
array heads[3] = ['(a) stiffness over weight', '(b) damping', '(c) friction of the floor']
set ylabel 'posterior over prior'
set yrange [0:*]
set format x '10^{%T}'
do for [k=1:3] {
    name = word('stiffness damping_rate floor_friction', k)
    eval panel(k, heads[k])
    set xlabel group[k]
    if (k < 3) { set logscale x } else { unset logscale x; set format x '%h' }
    set xrange [least[k]:largest[k]]
    set arrow 1 from graph 0, first 1 to graph 1, first 1 nohead ls guide
    plot chosen(name) using 'value':'all' with linespoints ls ours title 'all', \
         chosen(name) using 'value':'none' with lines ls 12 title 'numbers without a common error', \
         chosen(name) using 'value':'common' with lines ls 13 title 'numbers with a common error'
}
unset arrow 1
numbers = 'lh_forensics_posterior_numbers.tsv'
role(name) = rows(numbers, 'role', name)
eval panel(4, '(d) predicted against published')
set autoscale y
set xlabel 'published {/:Italic θ}_R (degrees)'
set ylabel 'predicted {/:Italic θ}_R (degrees)'
set xrange [14:24]
set yrange [14:28]
plot x with lines ls guide notitle, \
     role('used') using 'published_deg':'predicted_deg':'published_se_deg':'predicted_sd_deg' with xyerrorbars ls ours title 'used', \
     role('held_out') using 'published_deg':'predicted_deg':'published_se_deg':'predicted_sd_deg' with xyerrorbars ls 2 title 'held out'
