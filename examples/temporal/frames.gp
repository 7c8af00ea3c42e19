# Variables: table (sigma_px,frame,case...), title, term, name.
set terminal @term
set output name
set datafile separator ","
set logscale y
set yrange [0.03:2]
set xlabel "frame"
set ylabel "perceptual error over white noise's"
set grid
set key outside right noenhanced
set multiplot layout 2,1 title title noenhanced
columns = int(system(sprintf("head -1 %s | tr ',' '\\n' | wc -l", table)))
do for [s = 1:2] {
    set title sprintf("Gaussian of %d px", s)
    plot for [c = 3:columns] table using ($1 == s ? $2 : NaN):c with linespoints pt 7 ps 0.4 \
        title columnheader(c)
}
unset multiplot
