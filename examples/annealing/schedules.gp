# Energy over the optimum's, and temperature, by proposals. Variables: out, term, name.
set terminal @term
set output name
set datafile separator ","
set logscale xy
set key outside right
set grid
schedules = "kirkpatrick exponential inverse linear hajek"
optimum = real(system(sprintf("sed -n 's/^exact,\\([0-9]*\\),.*/\\1/p' %s/table.csv", out)))
set multiplot layout 2,1
set ylabel "energy over the optimum"
plot for [s in schedules] sprintf("%s/%s.csv", out, s) using 1:($3 / optimum) skip 1 with lines title s
set xlabel "proposed exchanges"
set ylabel "temperature, steps of the mask"
plot for [s in schedules] sprintf("%s/%s.csv", out, s) using 1:2 skip 1 with lines title s
unset multiplot
