# Accepted share of changes for the worse, by their size, as it cools. Variables: table, term, name.
set terminal @term
set output name
set datafile separator ","
set logscale x
set xlabel "proposed exchanges"
set ylabel "accepted share"
set key outside right title "change for the worse,\nsixteenths of twice the range"
set grid
plot for [b in "1 2 4 8 12"] table using 1:(column(4 + int(b))) skip 1 with lines title b
