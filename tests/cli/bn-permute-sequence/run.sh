# The same seeds from one run of the passes, for any number of threads; a still image of any size.
set -eu
result() { python3 -c 'import json, sys; print(*json.load(open(sys.argv[1]))["result"].items())' "$1"; }
"$SRC/tests/cli/make_image" frame.exr 37x21 R='noise()' G='noise()' B='noise()' motion.X='1.2+x/100' motion.Y='-2'
"$SRC/tests/cli/make_image" guides.exr 37x21 id:uint='1 if x < 20 else 2' N.X='x/37' N.Y=0 N.Z=1
bn-mask --size 16x16 -o mask.png
bn-anneal mask.png --motions 2 --radius 3 -o textures.exr
bn-permute --image frame.exr --mask mask.png -o s1.exr --stats s1.json
result s1.json
bn-permute --image frame.exr --mask mask.png --seeds s1.exr --retarget textures.exr --frame 1 \
    --reproject image --motion frame.exr --block-jitter --similar guides.exr -o s2.exr --stats s2.json
result s2.json
bn-permute --image frame.exr --mask mask.png --seeds s2.exr --retarget textures.exr --frame 2 \
    --reproject tile --motion frame.exr --block 5 --format exr -o - >s3.exr
bn-permute --image frame.exr --mask mask.png --seeds s2.exr --retarget textures.exr --frame 2 \
    --reproject tile --motion frame.exr --block 5 -j 3 -o again.exr
cmp s3.exr again.exr
bn-permute --image frame.exr --mask mask.png --seeds s2.exr --frame 3 --refresh 4 -o s4.exr --stats s4.json
result s4.json
"$SRC/tests/cli/make_image" one.exr 1x1 Y=0.5
"$SRC/tests/cli/make_image" one_seed.exr 1x1 seed:uint=4000000000
bn-permute --image one.exr --mask mask.png --seeds one_seed.exr --retarget textures.exr -o two.exr
