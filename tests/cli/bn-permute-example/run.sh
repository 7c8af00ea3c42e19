# The worked example of bn-mask(1), bn-anneal(1) and bn-permute(1), made by the tools.
set -eu
make=$SRC/tests/cli/make_image
bn-mask --method bayer --size 4x4 -o bayer.exr
"$make" expected_mask.exr 4x4 'Y=([0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5][x + 4 * y] + 0.5) / 16'
img-diff --identical bayer.exr expected_mask.exr
bn-anneal bayer.exr --step 1,0 --radius 1 -o move.png
"$make" expected_move.png 4x4 R=127 G=128 B=0
img-diff --identical move.png expected_move.png
bn-anneal bayer.exr --step 1,0 --radius 1 -o move.exr --stats stats.json
python3 -c 'import json; print(json.load(open("stats.json"))["result"]["energy"])'
"$make" image.exr 4x4 'Y=x + 4 * y'
"$make" seeds.exr 4x4 'seed:uint=100 + x + 4 * y'
bn-permute --image image.exr --seeds seeds.exr --mask bayer.exr --retarget move.exr --frame 1 --block 4 \
    -o next.exr
"$make" expected_next.exr 4x4 'seed:uint=[102, 110, 100, 108, 114, 106, 112, 104,
    101, 109, 103, 111, 113, 105, 115, 107][x + 4 * y]'
img-diff --identical next.exr expected_next.exr
