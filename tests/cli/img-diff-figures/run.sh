# Figures that can be worked out by hand, in the three forms
"$SRC/tests/cli/make_image" a.exr 16x8 R=2.5 G=2 B=2
"$SRC/tests/cli/make_image" b.exr 16x8 R=2 G=2 B=2
img-diff --per-channel a.exr b.exr | grep -vE '^[GB]\.|perceptual'
img-diff --json --channels R a.exr b.exr | python3 -c 'import json, sys; d = json.load(sys.stdin); print(d["image"], d["reference"], d["mse"], d["samples"])'
img-diff --json a.exr a.exr | grep psnr
cp a.exr 'a, "b".exr'
img-diff --csv --channels R 'a, "b".exr' b.exr | cut -d, -f1-6
img-diff --crop 4,2,3,5 a.exr b.exr | grep samples
cat a.exr | img-diff - b.exr | head -1
