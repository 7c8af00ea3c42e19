# Variables: out (folder of the CSV files), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set format "10^{%T}"
set xlabel "seconds on one thread"
set ylabel "relMSE of the indirect layer"
set key outside right
set grid
# Half the difference of two references is the error of one.
reference = real(system(sprintf("awk -F, 'NR == 1 { for (i = 1; i <= NF; ++i) if ($i == \"relmse\") c = i } NR == 2 { print $c / 2 }' %s/reference.csv", out)))
plot for [g in "pattern importance full jittered compensate path"] \
    sprintf("%s/error_%s.csv", out, g) using 5:10 skip 1 with linespoints pt 7 ps 0.7 title g, \
    reference with lines dt 2 lc "black" title "error of the reference"
