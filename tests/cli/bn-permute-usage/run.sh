# Wrong calls and inputs that do not fit each other: one line each, and no file.
"$SRC/tests/cli/make_image" frame.exr 9x5 R=x G=y B=0
"$SRC/tests/cli/make_image" small.exr 8x5 seed:uint=x
"$SRC/tests/cli/make_image" broken.exr 9x5 Y=nan
bn-mask --size 8x8 -o mask.png
bn-mask --size 8x8 --seed 1 -o other.png
bn-anneal mask.png --radius 1 -o texture.png
bn-anneal other.png --radius 1 -o other_texture.exr
refused() {
    local wanted=$1
    shift
    bn-permute --mask mask.png "$@"
    [ $? -eq "$wanted" ] || echo "wrong status: $*"
}
refused 2 --image frame.exr -o out.png
refused 2 --image frame.exr --reproject image --retarget texture.png -o out.exr
refused 2 --image frame.exr --motion frame.exr -o out.exr
refused 2 --image frame.exr --depth frame.exr --reproject tile -o out.exr
refused 3 --image frame.exr --seeds small.exr -o out.exr
refused 3 --image frame.exr --seeds frame.exr -o out.exr
refused 3 --image broken.exr -o out.exr
refused 3 --image frame.exr --retarget other_texture.exr -o out.exr
refused 3 --image frame.exr --retarget texture.png --offsets r2 -o out.exr
refused 3 --image frame.exr --retarget mask.png -o out.exr
refused 3 --image frame.exr --retarget texture.png --reproject tile --motion frame.exr -o out.exr
# Channels that nobody asked for may be what they like
"$SRC/tests/cli/make_image" deep.exr 9x5 R=x G=y B=0 Z=inf id:uint=x
bn-permute --mask mask.png --image deep.exr --similar deep.exr -o good.exr || echo "a depth that nobody asked for"
ls out* 2>/dev/null
:
