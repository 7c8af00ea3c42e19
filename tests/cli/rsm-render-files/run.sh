# The same bytes for any thread count, through a pipe as in a file; maps; a mask from bn-mask.
set -eu
scene=$SRC/examples/scenes/cornell_spot.gltf
render() { rsm-render "$scene" --size 17x13 --rsm-size 24 --samples 9 "$@"; }
for gather in pattern importance; do
    render --gather $gather -j 1 --rsm-out map.one.exr -o one.exr
    render --gather $gather -j 2 --rsm-out map.two.exr -o two.exr
    cmp one.exr two.exr
    cmp map.one.exr map.two.exr
done
render --compensate --interpolate 4 -j 1 -o one.exr
render --compensate --interpolate 4 -j 2 -o two.exr
cmp one.exr two.exr
render --format exr -o - >pipe.exr
render -o file.exr
cmp pipe.exr file.exr

# The sum is the sum of its layers; another seed is another image.
oiiotool file.exr --ch direct.R,direct.G,direct.B --chnames R,G,B file.exr --ch indirect.R,indirect.G,indirect.B \
    --chnames R,G,B --add -d float -o layers.exr
img-diff --max-abs 1e-6 layers.exr file.exr >/dev/null
render --gather pattern --mips on --direct map --half -o half.exr
render --seed 1 -o seed.exr
cmp -s seed.exr file.exr && echo "the seed changes nothing"
bn-mask --size 32x32 -o mask.png
render --rotate blue --mask mask.png -o blue.png
render --rotate blue -o own.png
cmp -s blue.png own.png && echo "the mask changes nothing"

# Frames and statistics.
render --frames 1-2 -o frame.%04d.exr --stats stats.json
grep -o '"gather_shadow"' stats.json
grep -o '"interpolated_share"' stats.json

# A time limit adds passes until then: what they make is what --spp makes.
rsm-render "$scene" --time-limit 0.2 --size 4x4 --rsm-size 8 -o limited.exr --stats limited.json
passes=$(sed -n 's/.*"passes": \([0-9]*\).*/\1/p' limited.json)
[ "$passes" -gt 1 ] || echo "one pass in a time for hundreds"
rsm-render "$scene" --spp "$passes" --size 4x4 --rsm-size 8 -o same.exr
cmp limited.exr same.exr
# The first pass is always made, and --spp stays the most there are.
rsm-render "$scene" --time-limit 0.001 --size 64x64 -o limited.exr --stats limited.json
grep -o '"passes": 1\b' limited.json
rsm-render "$scene" --time-limit 60 --spp 2 --size 4x4 --rsm-size 8 -o limited.exr --stats limited.json
grep -o '"passes": 2' limited.json

# Measuring rays changes no bit.
render --measure-rays -o measured.exr --stats stats.json
cmp measured.exr file.exr
grep -o '"share_of_bare"' stats.json
ls
