# Directions of a Phong lobe, and of the shafts that are read for it. Set `table`, terminal and output.
set datafile separator ','
set xlabel 'degrees from the middle of the lobe'
set ylabel 'share of directions in 5 degrees'
set xrange [0:90]
rows(n) = "<awk -F, '$1 == ".n."' ".table
exponents = system("awk -F, 'NR > 1 && !seen[$1]++ { print $1 }' ".table)
plot for [i = 1:words(exponents)] rows(word(exponents, i)) using 2:3 with lines lc i dt 2 title 'lobe, exponent '.word(exponents, i), \
     for [i = 1:words(exponents)] rows(word(exponents, i)) using 2:4 with lines lc i lw 2 title 'shafts, exponent '.word(exponents, i)
