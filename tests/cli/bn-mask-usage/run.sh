# Each wrong call: one line, exit status 2, no file.
refused() {
    bn-mask "$@" -o mask.exr && echo "not refused: $*"
    status=$?
    [ $status -eq 2 ] || echo "status $status: $*"
}
refused --method bayer --size 6x8
refused --method bayer --seed 1
refused --method white --sigma 2
refused --sigma 0.1
refused --sigma nan
refused --size 100000x100000
refused --size 4096x4096 --max-memory 0.1
bn-mask --channels 2 -o mask.png
[ $? -eq 2 ] || echo "two channels in PNG"
ls
