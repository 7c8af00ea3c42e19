# Variables: out (folder of the profiles), term, name.
set terminal @term
set output name
set datafile separator ","
set logscale y
set yrange [1e-6:100]
set format y "10^{%T}"
set xrange [0:0.7]
set xlabel "cycles per pixel"
set ylabel "radial mean power, white noise = 1"
set key outside right
set grid
plot for [k in "white bayer blue1.2 blue1.5 blue1.9 tiled"] sprintf("%s/profile-%s.csv", out, k) \
    using 1:3 skip 1 with lines title k
