# The same bytes for any thread count, and through a pipe as in a file.
set -eu
bn-mask --size 24x17 --channels 3 --seed 5 -j 1 -o one.exr
bn-mask --size 24x17 --channels 3 --seed 5 -j 2 -o two.exr
cmp one.exr two.exr
bn-mask --size 24x17 -o file.png
bn-mask --size 24x17 --format png -o - >pipe.png
cmp file.png pipe.png
bn-mask --method bayer --size 8x8 -o bayer.png
bn-mask --method white --size 7x1 -o white.exr
ls
