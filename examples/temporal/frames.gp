# Variables: table (sigma_px,frame,case...), title, term, name. Cases that only vary another one's
# blocks are left to the table.
set terminal @term
set output name
set datafile separator ","
set yrange [0:1.3]
set xlabel "frame"
set ylabel "perceptual error over white noise's"
set grid
set key outside right noenhanced
set multiplot layout 2,1 title title noenhanced
columns = system(sprintf("head -1 %s | tr ',' '\\n' | grep -nEv '^(sigma_px|frame|.*[0-9]+|jitter|short|similar|demodulate)$' | cut -d: -f1", table))
do for [s = 1:2] {
    set title sprintf("Gaussian of %d px", s)
    plot for [c in columns] table using ($1 == s ? $2 : NaN):(column(int(c))) with linespoints pt 7 ps 0.4 \
        title columnheader(int(c))
}
unset multiplot
