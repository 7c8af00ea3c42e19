# Variables: out (folder of the CSV files), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set format "10^{%T}"
set xlabel "seconds"
set ylabel "relMSE of the indirect layer"
set key outside right
set grid
plot for [g in "pattern importance jittered compensate path"] \
    sprintf("%s/error_%s.csv", out, g) using 4:8 skip 1 with linespoints pt 7 ps 0.7 title g
