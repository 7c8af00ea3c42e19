# bn-render's temporal seeds are those that bn-permute makes of the same frames, bit for bit, and a
# sequence in two parts is the sequence in one.
set -eu
scene=$SRC/examples/scenes/cornell_moving_camera.gltf
bn-mask --size 16x16 -o mask.exr
bn-anneal mask.exr --motions 1 --radius 3 -o moves.exr
bn-anneal mask.exr --radius 3 -o still.exr

# render NAME ARGS...: frames 0-3 with the channels that the passes may look at.
render() {
    name=$1
    shift
    bn-render "$scene" --size 37x29 --distribution temporal --mask mask.exr --aov all,normal "$@" \
        --spp 2 -o "$name.%d.exr" --seeds-out "$name.s%d.exr"
}
# same NAME ARGS...: bn-permute makes the seeds of each frame from the frame before.
same() {
    name=$1
    shift
    for frame in 0 1 2; do
        next=$((frame + 1))
        bn-permute --image "$name.$frame.exr" --seeds "$name.s$frame.exr" --mask mask.exr "$@" \
            --frame $frame -o permuted.exr
        img-diff --identical permuted.exr "$name.s$next.exr" || echo "$name: frame $next differs"
    done
}

render sort --frames 0-3 --block 4
same sort --block 4
render still --frames 0-3 --retarget still.exr --refresh 3 --seed 5
same still --retarget still.exr --refresh 3 --seed 5
for motion in image tile; do
    render $motion --frames 0-3 --retarget moves.exr --reproject $motion --block-jitter
    for frame in 0 1 2; do
        bn-permute --image $motion.$frame.exr --seeds $motion.s$frame.exr --mask mask.exr \
            --retarget moves.exr --reproject $motion --motion $motion.$frame.exr --block-jitter \
            --frame $frame -o permuted.exr
        img-diff --identical permuted.exr $motion.s$((frame + 1)).exr || echo "$motion: $frame"
    done
done
render alike --frames 0-3 --similar
for frame in 0 1 2; do
    bn-permute --image alike.$frame.exr --seeds alike.s$frame.exr --mask mask.exr \
        --similar alike.$frame.exr --frame $frame -o permuted.exr
    img-diff --identical permuted.exr alike.s$((frame + 1)).exr || echo "alike: $frame"
done
render even --frames 0-3 --retarget still.exr --demodulate
for frame in 0 1 2; do
    bn-permute --image even.$frame.exr --seeds even.s$frame.exr --mask mask.exr \
        --retarget still.exr --albedo even.$frame.exr --frame $frame -o permuted.exr
    img-diff --identical permuted.exr even.s$((frame + 1)).exr || echo "even: $frame"
done
img-diff --identical even.s3.exr still.s3.exr 2>/dev/null | sed "s/[1-9][0-9]*/many/"

# Frames 2-3 from the seeds of frame 2.
render part --frames 2-3 --retarget still.exr --refresh 3 --seed 5 --seeds still.s2.exr
img-diff --identical part.3.exr still.3.exr
