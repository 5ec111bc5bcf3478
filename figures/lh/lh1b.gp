# Lee & Herrmann 1993, figure 1(b): kinetic energy per grain against the iteration.
# tables: lh1/energy.tsv
heading = 'Kinetic energy before and after opening'
remark = 'dashed: the right wall is removed'
load 'figures/style.gp'
opened = real(system("sed -n 's/.*open_at_step = \\([0-9][0-9]*\\).*/\\1/p' ".T."lh1/scene.cfg"))
set xlabel 'iteration (thousands)'
set ylabel 'energy per grain (erg)'
set logscale y
set format y '10^{%T}'
set yrange [1e-9:100]
set xrange [0:*]
set arrow 1 from opened/1000, graph 0 to opened/1000, graph 1 nohead ls guide
plot t('lh1/energy.tsv') using (column('step')/1000):(column('kinetic_per_grain')) with lines lw 0.7 lc 'black' notitle
