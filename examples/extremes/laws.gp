# Plots of points.csv: deviation against the parameter of each law. Set `folder` on the command line.
set datafile separator ','
set key outside right
points = folder . '/points.csv'
select(law, tool) = sprintf("< awk -F, '$1 == \"%s\" && $2 == \"%s\" && $6 == 0 { print $3 \",\" $4 }' %s", law, tool, points)
tools = 'bn-render rsm-render ls-sample'
drawn(x) = x < 1e-9 ? 1e-9 : x # what is equal is drawn at 1e-9

do for [type in 'svg png'] {
    if (type eq 'svg') { set terminal svg size 900,1100 } else { set terminal pngcairo size 900,1100 }
    set output folder . '/laws.' . type
    set multiplot layout 4,1
    set logscale xy
    set format '10^{%L}'
    set yrange [1e-10:10]
    set ylabel 'deviation of the mean'
    set title 'Scene scaled by s, candela by s^2'
    set xlabel 's'
    plot for [t in tools] select('unit of length', t) using 1:(drawn($2)) with linespoints title t, 2e-3 title 'tolerance' dashtype 2
    set title 'Scene moved from the origin'
    set xlabel 'metres'
    plot for [t in tools] select('place', t) using 1:(drawn($2)) with linespoints title t, 2e-3 title 'tolerance' dashtype 2
    set title 'Light times a power of two'
    set xlabel 'factor'
    plot for [t in tools] select('light', t) using 1:(drawn($2)) with linespoints title t
    unset logscale y
    set format y '%g'
    set yrange [*:*]
    set title 'Furnace: radiance of what absorbs nothing, less 1'
    set xlabel "roughness (GGX), exponent (Phong), index of refraction (glass)"
    set ylabel ''
    laws = 'GGX Phong glass'
    plot for [l in laws] select('furnace ' . l, 'bn-render') using ($1 == 0 ? 1e-3 : $1):2 with linespoints title l
    unset multiplot
    unset logscale
    set output
}
