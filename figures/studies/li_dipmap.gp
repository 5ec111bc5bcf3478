# Depth of the dip of N under tents, continuum: (max N - N in the middle)/max N.
# sweeps: tent
heading = 'Depth of the dip of {/:Italic N} under tents'
remark = 'dashed: equal slopes; cross: the tent of figure 19'
panels = 4
ratio = 0.68
load 'figures/style.gp'
set xlabel 'outer slope α_1 (degrees)'
set ylabel 'inner slope α_2 (degrees)'
set xrange [0.5:59.5]
set yrange [0.5:59.5]
set xtics 15
set ytics 15
set cbrange [0:0.3]
set palette defined (0 '#ffffff', 0.02 '#fde0b2', 0.3 '#e69f00', 0.6 '#d55e00', 0.85 '#7a0177', 1 '#200030')
unset grid
set colorbox user horizontal origin screen 0.6, screen 1 - 0.55/height size screen 0.35, screen 0.25/height
set cbtics 0.1 offset 0, 0.3
do for [k=1:4] {
    part = word('20 30 38 45', k)
    if (k > 1) { unset colorbox }
    eval panel(k, sprintf('(%s) {/:Italic X}_1 = 0.%s {/:Italic B}', word('a b c d', k), part))
    plot t('tent/map_'.part.'.tsv') using (column('outer_deg')):(column('inner_deg')):(column('dip')) with image notitle, \
         [1:59] '+' using 1:1 with lines lw 0.7 dt 2 lc rgb '#666666' notitle, \
         '+' using (part eq '38' ? 30 : NaN):(45) every 1000 with points pt 1 ps 1.2 lw 1.5 lc rgb '#000000' notitle
}
