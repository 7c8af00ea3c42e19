# Channels, layers, parts that are missing; sizes that differ
make="$SRC/tests/cli/make_image"
"$make" a.exr 8x8 R=1 G=1 B=1 direct.R=2 direct.G=2 direct.B=2 seed:uint=x
"$make" b.exr 8x8 R=1 G=1 B=1 direct.R=3 direct.G=2 direct.B=2 seed:uint=x+1
"$make" wide.exr 9x8 R=1 G=1 B=1
"$make" words.exr 8x8 seed:uint=x
"$make" half.exr 8x8 R:half=1 G:half=1 B:half=1
"$make" grey.png 8x8 Y=51
try() { img-diff "$@" | head -1; echo "${PIPESTATUS[0]} $*"; }
try a.exr b.exr
try half.exr b.exr
try --layer direct a.exr b.exr
try --channels direct.R,G a.exr b.exr
try --channels seed a.exr b.exr
try --layer indirect a.exr b.exr
try --identical a.exr b.exr
try --identical a.exr a.exr
try --identical a.exr wide.exr
try --identical a.exr half.exr
try wide.exr a.exr
try words.exr a.exr
try a.exr words.exr
try --part 1 a.exr b.exr
try --part 0 a.exr b.exr
try --crop 0,0,9,8 a.exr b.exr
try --crop 8,0,1,1 a.exr b.exr
try --crop 0,0,0,1 a.exr b.exr
try --crop 1e99,0,1,1 a.exr b.exr
try --channels R,G --sigma 2 a.exr b.exr
try grey.png grey.png
try - - </dev/null
