# Choices that Lee & Herrmann 1993 leave open. (a) Change of theta_R at mu = 0.2 with each choice. (b) Likelihood of
# all published numbers under each combination, in decreasing order.
# tables: lh_forensics_combinations.tsv lh_forensics_effects.tsv
heading = 'Choices that Lee and Herrmann leave open'
remark = 'bars: 95 % interval'
panels = 2
across = 2
ratio = 0.5
legend = 2
load 'figures/style.gp'
combinations = 'lh_forensics_combinations.tsv'
effects = 'lh_forensics_effects.tsv'
# main effects on the first claim, and methods of surface detection, one per line from the top
lines = "< awk -F'\t' '!/^#/ && $1 == \"lh-theta\" { gsub(/_/, \" \", $2); gsub(/_/, \" \", $3); sub(/^[ ]/, \"\", $3); ".\
        "if ($2 == \"dt\") $3 = \"0.7 times\"; if ($2 == \"relax steps\") { $2 = \"measured after\"; $3 = \"1.0 s\" } if ($2 == \"open\") $3 = $3 \" cm/s\"; ".\
        "print ++n \"\\t\" $2 \" \" $3 \"\\t\" $5 \"\\t\" $7 \"\\t\" $8 }' ".path(effects)
ranked(status) = "< awk -F'\t' '/^rank\t/ { for (i = 1; i <= NF; i++) if ($i == \"log_likelihood\") l = i; next } ".\
        "!/^#/ && $NF == \"".status."\" { print $1 \"\\t\" $l }' ".path(combinations)
best = real(system("awk -F'\t' '/^rank\t/ { for (i = 1; i <= NF; i++) if ($i == \"log_likelihood\") l = i; next } !/^#/ { print $l; exit }' ".path(combinations)))
number = int(system("awk -F'\t' '!/^#/ && $1 == \"lh-theta\"' ".path(effects)." | wc -l"))
unset datafile
set datafile separator tab
eval panel(1, '(a) change of {/:Italic θ}_R with each choice')
set lmargin at screen 0.45
set xlabel 'change of {/:Italic θ}_R at {/:Italic μ} = 0.2 (degrees)'
set yrange [number + 0.8:0.2]
set ytics scale 0
set grid noytics
set arrow 1 from 0, graph 0 to 0, graph 1 nohead ls guide
plot lines using 3:1:4:5:ytic(2) with xerrorbars ls ours notitle
unset arrow 1
eval panel(2, sprintf('(b) %s of %s not excluded at 5 %%; %s by chance', note(combinations, 'not_excluded'), note(combinations, 'complete'), note(combinations, 'by_chance')))
set yrange [-25:1.5]
set xrange [0:200]
set ytics autofreq scale 0.6
set xlabel 'combination and method of surface detection, ordered'
set ylabel 'log likelihood relative to the best'
plot ranked('excluded') using 1:($2 - best) with points ls 2 pt 4 ps 0.35 title 'excluded', \
     ranked('not_excluded') using 1:($2 - best) with points ls ours title 'not excluded'
