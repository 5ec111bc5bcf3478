# Choices that Lee & Herrmann 1993 leave open. (a) Change of theta_R at mu = 0.2 with each choice. (b) Likelihood of
# all published numbers under each combination, in decreasing order.
# tables: lh_forensics_combinations.tsv lh_forensics_effects.tsv
width = 20.0
height = 12.0
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
set multiplot
set origin 0, 0
set size 0.56, 1
set lmargin 25
set xlabel 'change of {/:Italic θ}_R at {/:Italic μ} = 0.2 (degrees)'
set yrange [number + 0.8:0.2]
set ytics font ',7' scale 0
set grid noytics
set arrow 1 from 0, graph 0 to 0, graph 1 nohead lw 0.7 lc rgb '#808080'
set label 1 '(a)' at graph 0.02, 0.975 font ',9'
set label 2 'bars: 95 % interval' at graph 0.98, 0.02 right font ',7'
plot lines using 3:1:4:5:ytic(2) with xerrorbars pt 7 ps 0.5 lc 3 notitle
unset arrow 1
set origin 0.55, 0
set size 0.45, 1
set lmargin 9
set yrange [*:*]
set ytics font ',8' scale 0.6
set xlabel 'combination and method of surface detection, ordered'
set ylabel 'log likelihood relative to the best'
set yrange [-25:1.5]
set xrange [0:200]
set label 1 '(b)' at graph 0.03, 0.975 font ',9'
set label 2 sprintf('%s of %s not excluded at 5 %%; %s by chance', system("sed -n 's/^# not_excluded: //p' ".path(combinations)), system("sed -n 's/^# complete: //p' ".path(combinations)), system("sed -n 's/^# by_chance: //p' ".path(combinations))) at graph 0.03, 0.05 left font ',7'
set key top right
plot ranked('excluded') using 1:($2 - best) pt 6 ps 0.35 lc 1 title 'excluded', \
     ranked('not_excluded') using 1:($2 - best) pt 7 ps 0.5 lc 3 title 'not excluded'
unset multiplot
