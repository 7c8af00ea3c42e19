# Variables: out (folder of the CSV files), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set format y "10^{%T}"
set xlabel "passes of 16 samples"
set ylabel "relative RMS error against every texel of the map"
set key top right
set grid
data = sprintf("%s/converge.csv", out)
of(g) = sprintf("< awk -F, '$2 == \"%s\"' %s", g, data)
first = real(system(sprintf("awk -F, '$2 == \"importance\" { print sqrt($10); exit }' %s", data)))
plot for [g in "importance pattern"] of(g) using 3:(sqrt($10)) with linespoints pt 7 ps 0.7 title g, \
    first / sqrt(x) with lines dt 2 lc "black" title "slope -1/2"
