# Bias over voxels and patches. Set `table`, terminal and output.
set datafile separator ','
set logscale x 2
set xtics (6, 12, 25, 50, 100)
set xlabel 'voxels along a side'
rows(n, k) = "<awk -F, '$2 == ".n." && $3 == ".k."' ".table
patches = system("awk -F, 'NR > 1 && !seen[$2]++ { print $2 }' ".table)
set multiplot layout 1,2
set key bottom right
set ylabel 'mean of indirect light, cache over path tracing'
plot for [n in patches] rows(n, '0') using 1:5 with linespoints title 'N = '.n, \
     rows(word(patches, words(patches)), '1000') using 1:5 with linespoints lc rgb 'black' dt 2 title 'k = 1000', \
     1 with lines lc rgb 'gray' notitle
set logscale y
set format y '10^{%T}'
set key top right
set ylabel 'relMSE of means of 8 x 8 pixels, bias alone'
plot for [n in patches] rows(n, '0') using 1:($8 > 0 ? $8 : NaN) with linespoints title 'N = '.n, \
     rows(word(patches, words(patches)), '1000') using 1:($8 > 0 ? $8 : NaN) with linespoints lc rgb 'black' dt 2 title 'k = 1000'
unset multiplot
