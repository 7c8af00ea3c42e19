# The same bytes for any number of threads, through a pipe, and for frames alone or in sequence.
set -eu
block=$SRC/examples/scenes/cornell_moving_block.gltf
bn-render "$block" --size 40x30 --frames 0-4x2 --aov all --spp 2 -j 1 -o one.%04d.exr
bn-render "$block" --size 40x30 --frames 0-4x2 --aov all --spp 2 -j 2 -o two.%04d.exr
bn-render "$block" --size 40x30 --frames 4 --aov all --spp 2 -o alone.%04d.exr
bn-render "$block" --size 40x30 --frames 4 --aov all --spp 2 --format exr -o - >pipe.exr
for frame in 0000 0002 0004; do cmp one.$frame.exr two.$frame.exr; done
cmp one.0004.exr alone.0004.exr
cmp one.0004.exr pipe.exr
cmp -s one.0000.exr one.0002.exr && echo "two frames are the same"
bn-render "$SRC/examples/scenes/cornell_point.gltf" --size 16x16 --half -o half.exr
bn-render "$SRC/examples/scenes/cornell_point.gltf" --size 16x16 --exposure 2 -o bright.png
ls
