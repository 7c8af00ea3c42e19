# A plane wave along x with 8 cycles in 64 pixels: f = 1/8, all power in one pair of entries
make="$SRC/tests/cli/make_image"
"$make" wave.exr 64x32 'Y=1 + cos(2 * pi * x / 8)'
"$make" one.exr 64x32 Y=1
"$make" wide.exr 65x32 Y=1
round() { sed -E 's/^([a-z_0-9.]+px|[a-z_0-9]+) (.*)$/\1 \2/' | python3 -c '
import sys
for line in sys.stdin:
    name, value = line.split()
    print(name, f"{float(value):.4f}".replace("-0.0000", "0.0000"))'; }
img-spectrum wave.exr | round | grep -v anisotropy
img-spectrum --reference one.exr wave.exr wave.exr | round | grep -E "frames|^mean"
img-spectrum --json --sigma 3 wave.exr | grep -c -E '"image"|"filtered_(variance|to_white)_3px"'
img-spectrum wave.exr --profile profile.csv --picture wave.png >/dev/null
head -1 profile.csv
awk -F, 'NR > 1 && $3 > 1e-6 { printf "%s %.2f\n", $1, $3 }' profile.csv
img-spectrum wave.exr --profile profile.json >/dev/null
python3 -c 'import json; print(len(json.load(open("profile.json"))), open("profile.csv").read().count("\n") - 1)'
img-diff --json wave.png wave.png | grep mean_image
img-spectrum one.exr | grep -E "^(variance|low_frequency_share) "
img-spectrum one.exr wide.exr
echo $?
img-spectrum --reference wide.exr one.exr
echo $?
# Masks in R, G and B are three, a grey picture is one
bn-mask --size 16x16 --channels 3 -o masks.exr
bn-mask --size 16x16 -o mask.exr
oiiotool mask.exr --ch Y,Y,Y --chnames R,G,B -o grey.exr
img-spectrum --mask masks.exr | grep -E "^frames|^distinct"
img-spectrum --mask grey.exr | grep -E "^frames|^distinct"
