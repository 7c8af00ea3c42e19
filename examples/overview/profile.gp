# Power of the error by frequency, white and blue. Arguments: picture, profile of white, of blue.
set terminal pngcairo size 640,640 font ",15"
set output ARG1
set datafile separator ","
set logscale y
set yrange [0.2:3]
set xrange [0:0.5]
set xlabel "cycles per pixel"
set ylabel "power, white noise of the same variance = 1"
set key bottom right
set grid lc rgb "#dddddd"
plot ARG2 using 1:3 skip 1 with lines lw 2 lc rgb "#888888" title "white", \
    ARG3 using 1:3 skip 1 with lines lw 3 lc rgb "#2171b5" title "blue"
