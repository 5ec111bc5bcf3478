# Depth of the dip of N under tents, continuum: (max N - N in the middle)/max N.
# tables: tent_map_20.tsv tent_map_30.tsv tent_map_38.tsv tent_map_45.tsv
width = 17.0
height = 15.0
load 'figures/style.gp'
set multiplot layout 2, 2
set size ratio -1
set xlabel 'α_1, outer slope (degrees)'
set ylabel 'α_2, inner slope (degrees)'
set xrange [0.5:59.5]
set yrange [0.5:59.5]
set xtics 15
set ytics 15
set cbrange [0:0.3]
set cblabel 'dip'
set palette defined (0 '#ffffff', 0.02 '#fde0b2', 0.3 '#e69f00', 0.6 '#d55e00', 0.85 '#7a0177', 1 '#200030')
unset grid
do for [part in '20 30 38 45'] {
    set title '{/:Italic X}_1 = 0.'.part.' {/:Italic B}'
    plot t('tent_map_'.part.'.tsv') using (column('outer_deg')):(column('inner_deg')):(column('dip')) with image notitle, \
         [1:59] '+' using 1:1 with lines lw 0.7 dt 2 lc rgb '#666666' notitle, \
         '+' using (part eq '38' ? 30 : NaN):(45) every 1000 with points pt 1 ps 1.2 lw 1.5 lc rgb '#000000' notitle
}
unset multiplot
