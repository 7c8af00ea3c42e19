# Variables: out (folder of the CSV files), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set xlabel "texels along a side of the map"
set ylabel "block relMSE, |1 - mean ratio|"
set key top right
set grid
plot sprintf("%s/full.csv", out) using 3:11 skip 1 with linespoints pt 7 title "block relMSE", \
    sprintf("%s/full.csv", out) using 3:(abs(1 - $9)) skip 1 with linespoints pt 5 title "mean", \
    0.01 with lines dt 2 lc "black" title "1 %"
