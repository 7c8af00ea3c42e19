# Each wrong call: one line, exit status 2, no file.
scene=$SRC/examples/scenes/cornell_spot.gltf
refused() {
    rsm-render "$scene" --size 8x8 "$@" -o image.exr && echo "not refused: $*"
    status=$?
    [ $status -eq 2 ] || echo "status $status: $*"
}
refused --gather full --samples 4
refused --gather full --rotate none
refused --gather full --mips on
refused --gather importance --weights thesis
refused --mask mask.exr
refused --compensate --shadow-test off
refused --compensate --clamp none
refused --compensate --weights thesis
refused --measure-rays --shadow-test off
refused --clamp distance=0
refused --clamp sphere
refused --radius 0
refused --radius nan
refused --interpolate 17
refused --rsm-size 0
refused --rsm-size 8192 --max-memory 0.5
refused --aov motion
refused --aov variance --spp 1
refused --frames 0-1
refused --rsm-out map.png
refused --max-memory nan
rsm-render "$scene" --size 4x4 --rsm-size 16 --aov all -o all.exr --stats all.json --compensate
grep -o '"texels": "jittered"' all.json
rm all.*
ls
