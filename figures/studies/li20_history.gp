# Dropped piles of twenty settings: whether N dips in the middle of their base, and whether the contacts of their flanks tell.
# sweeps: li20_history
heading = 'Dips of dropped piles by the way in which they were made'
remark = sprintf('%d piles to a setting, means with 95 %% intervals; excess: {/:Italic N} of the middle less that of 60-degree rays; middle: less that of its neighbours. Setting: {/:Italic s} source 60 {/:Italic d} wide; {/:Italic h} fall; {/:Italic μ}_r rolling resistance; {/:Italic σ} scatter of the radii; {/:Italic μ}_b friction of the base; {/:Italic l} distance of the disks that are glued to the base', most('li20_history/points.tsv', 'excess_n'))
panels = 2
legend = 1
ratio = 1.25
load 'figures/style.gp'
c(name) = column(name)
# Student's t of 30 piles
low(mean, se) = c(mean) - 2.05*c(se)
high(mean, se) = c(mean) + 2.05*c(se)
eval panel(1, '(a) by setting')
set xlabel 'over mean {/:Italic N}'
set xrange [-0.2:0.4]
set xtics 0.1
set yrange [0:21]
m = '{/:Italic μ}'
set ytics ('point' 20, '{/:Italic s}' 19, '{/:Italic h} 0.5' 18, '{/:Italic h} 20' 17, m.' 0.2' 16, m.' 1' 15, m.'_r 0.05' 14, m.'_r 0.3' 13, \
           '{/:Italic σ} 5 %%' 12, '{/:Italic σ} 10 %%' 11, '{/:Italic σ} 20 %%' 10, '{/:Italic ε} 0.01' 9, m.'_b 0.2' 8, m.'_b 1' 7, \
           '{/:Italic l} 1' 6, '{/:Italic l} 1.5' 5, '{/:Italic l}, {/:Italic s}' 4, '{/:Italic l}, {/:Italic σ}' 3, \
           '{/:Italic l}, {/:Italic σ}, '.m 2, '{/:Italic σ}, '.m 1)
set arrow 1 from 0, graph 0 to 0, graph 1 nohead ls guide
set arrow 2 from -0.05, graph 0 to -0.05, graph 1 nohead ls guide
plot t('li20_history/points.tsv') using (c('excess_mean')):(20 - column(0)):(low('excess_mean', 'excess_se')):(high('excess_mean', 'excess_se')) with xerrorbars ls ours title 'excess', \
     '' using (c('middle_mean')):(19.7 - column(0)):(low('middle_mean', 'middle_se')):(high('middle_mean', 'middle_se')) with xerrorbars ls 2 title 'middle'
unset arrow 1
unset arrow 2
eval panel(2, '(b) by the contacts of the flanks')
set xlabel 'principal direction from the vertical (degrees)'
set ylabel 'excess over mean {/:Italic N}'
set xrange [*:*]
set yrange [*:*]
set xtics autofreq
set ytics autofreq
rough(x) = strcol('glued') eq 'none' ? NaN : x
flat(x) = strcol('glued') eq 'none' ? x : NaN
plot t('li20_history/points.tsv') using (c('fabric_deg_mean')):(flat(c('excess_mean'))):(low('fabric_deg_mean', 'fabric_deg_se')):(high('fabric_deg_mean', 'fabric_deg_se')):(low('excess_mean', 'excess_se')):(high('excess_mean', 'excess_se')) \
       with xyerrorbars ls ours title 'flat base', \
     '' using (c('fabric_deg_mean')):(rough(c('excess_mean'))):(low('fabric_deg_mean', 'fabric_deg_se')):(high('fabric_deg_mean', 'fabric_deg_se')):(low('excess_mean', 'excess_se')):(high('excess_mean', 'excess_se')) \
       with xyerrorbars ls 2 title 'rough base'
