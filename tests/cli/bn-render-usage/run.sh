# Each wrong call: one line, exit status 2, no file.
scene=$SRC/examples/scenes/cornell_point.gltf
refused() {
    bn-render "$@" && echo "not refused: $*"
    status=$?
    [ $status -eq 2 ] || echo "status $status: $*"
}
refused "$scene"
refused -o image.exr
refused "$scene" --frames 0-1 -o image.exr
refused "$scene" --aov depth,shine -o image.exr
refused "$scene" --aov variance -o image.exr
refused "$scene" --spp 0 -o image.exr
refused "$scene" --max-depth 0 -o image.exr
refused "$scene" --camera nobody -o image.exr
refused "$scene" --look-from 1,2,3 -o image.exr
refused "$scene" --look-from 1,2,3 --look-at 1,2,3 -o image.exr
refused "$scene" --fov 180 -o image.exr
refused "$scene" --sky 1,2 -o image.exr
refused "$scene" --sky 1,-2,1 -o image.exr
refused "$scene" --light-sampling luck -o image.exr
refused "$scene" --size 0x7 -o image.exr
refused "$scene" -o image.jpg
refused "$scene" --sky 1e39,1,1 -o image.exr
refused "$scene" --exposure nan -o image.exr
refused "$scene" --exposure inf -o image.exr
refused "$scene" --camera 0 --look-from 1,2,3 --look-at 0,0,0 -o image.exr
refused "$scene" --format png -o image.exr
refused "$scene" --seeds-out seeds.png -o image.exr
refused "$scene" --frames 0-1 -o 'image.%3d_%04d.exr'
# Options that would do nothing
bn-mask --size 8x8 -o mask.exr
refused "$scene" --mask mask.exr -o image.exr
refused "$scene" --estimates 4 -o image.exr
refused "$scene" --similar -o image.exr
refused "$scene" --distribution dithered --mask mask.exr --seeds-out seeds.exr -o image.exr
refused "$scene" --distribution histogram --mask mask.exr --seeds seeds.exr -o image.exr
refused "$scene" --distribution histogram --mask mask.exr --block 4 -o image.exr
refused "$scene" --distribution temporal --mask mask.exr --estimates 4 -o image.exr
rm mask.exr
ls
