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
refused() { bn-render "$scene" --size 24x16 --seeds "$1" -o none.exr && echo "accepted $1"; [ $? = 3 ]; }
refused missing.exr || echo wrong status
refused first.exr || echo wrong status
bn-render "$scene" --size 16x24 --seeds seeds.exr -o none.exr || [ $? = 3 ] && ls none.exr 2>/dev/null
exit 0
