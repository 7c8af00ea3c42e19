# Seeds written by one run bring the same image in another; other seeds another one.
set -eu
scene=$SRC/examples/scenes/cornell_area.gltf
bn-render "$scene" --size 24x16 --seed 9 --seeds-out seeds.exr -o first.exr
bn-render "$scene" --size 24x16 --seeds seeds.exr --seeds-out again.exr -o second.exr
img-diff --identical first.exr second.exr
img-diff --identical seeds.exr again.exr
bn-render "$scene" --size 24x16 --seed 10 -o third.exr
img-diff --identical first.exr third.exr >other.txt 2>&1 && echo "two seeds, one image"

# Seeds that do not fit: one line each, no file.
refused() {
    bn-render "$scene" "$@" -o none.exr && echo "accepted $*"
    status=$?
    [ $status = 3 ] || echo "status $status: $*"
    [ ! -e none.exr ] || echo "left an image: $*"
}
set +e
refused --size 24x16 --seeds missing.exr
refused --size 24x16 --seeds first.exr
refused --seeds seeds.exr --size 16x24
