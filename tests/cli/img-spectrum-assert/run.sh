# Conditions decide the exit status; wrong ones are usage errors and nothing is printed or written
"$SRC/tests/cli/make_image" wave.exr 64x32 'Y=cos(2 * pi * x / 8)'
"$SRC/tests/cli/make_image" flat.exr 8x8 Y=1
try() { img-spectrum "$@" >out.txt; echo "$? $(wc -l <out.txt | sed 's/^[1-9].*/some/') $*"; }
try wave.exr --assert 'low_frequency_share > 0.99'
try wave.exr --assert 'low_frequency_share<0.02'
try wave.exr --assert 'frames==1' --assert 'frames!=2' --assert 'frames<=1' --assert 'frames>=1'
try --assert 'frames==1' --sigma 1 --sigma 3 wave.exr
try wave.exr --assert 'frames==2' --assert 'frames<1'
try wave.exr --assert 'filtered_variance_1px>0.5'
try flat.exr --assert 'low_frequency_share<0.02'
try flat.exr --assert 'low_frequency_share!=0.02'
try wave.exr --assert 'blueness<0.02' --picture out.png
try wave.exr --assert 'heaviside_gauss_1<1'
try wave.exr --mask --assert 'heaviside_gauss_1<1'
try wave.exr --assert 'frames'
try wave.exr --assert 'frames<'
try wave.exr --assert 'frames=1'
try wave.exr --assert 'frames<nan'
try wave.exr --assert 'frames<1x'
try wave.exr --picture out.jpg
ls
