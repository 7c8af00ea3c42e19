# Variables: out (folder of the tables), cases, term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set xlabel "frames in the mean"
set ylabel "mean square error"
set grid
set key bottom left noenhanced
plot for [m in cases] sprintf("%s/mean-%s.csv", out, m) using 1:2 skip 1 \
    with linespoints pt 7 ps 0.4 title m
