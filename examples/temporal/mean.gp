# Variables: out (folder of the tables), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set xlabel "frames in the mean"
set ylabel "mse"
set grid
set key bottom left
plot for [m in "white never refresh64 refresh8"] sprintf("%s/mean-%s.csv", out, m) \
    using ($3 + 1):4 skip 1 with linespoints pt 7 ps 0.4 title m
