# Difference of two caches over photons. Set `table`, terminal and output.
set datafile separator ','
set logscale xy
set format '10^{%T}'
set xlabel 'photons'
set ylabel 'rms of the difference of two caches'
rows(k) = "<awk -F, '$2 == ".k."' ".table
first = real(system("awk -F, '$2 == 0 && NR > 1 { print $3 * sqrt($1); exit }' ".table))
plot for [k in '0 1000'] rows(k) using 1:3 with linespoints title 'k = '.k, \
     first / sqrt(x) with lines lc rgb 'black' dt 2 title 'slope -1/2'
