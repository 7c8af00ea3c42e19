# Scenes that the maps cannot light: one line and a status, or a black indirect layer.
emitter=$SRC/examples/scenes/cornell_area.gltf
spot=$SRC/examples/scenes/cornell_spot.gltf
small="--size 8x8 --rsm-size 8"
rsm-render "$emitter" $small -o dark.exr && echo "not refused: emitters alone"
[ $? -eq 3 ] || echo "status"
rsm-render "$emitter" $small --allow-dark -q --rsm-out map.exr -o dark.exr || echo "refused: --allow-dark"
[ -e map.exr ] && echo "a map of no light"
img-diff --json --layer indirect dark.exr dark.exr | grep '"mean_image"'

# Half a sphere fits no perspective map.
sed 's/"outerConeAngle": [0-9.]*/"outerConeAngle": 1.5707963/' "$spot" >wide.gltf
rsm-render wide.gltf $small --map perspective -o wide.exr && echo "not refused: 90 degrees"
[ $? -eq 3 ] || echo "status"
rsm-render wide.gltf $small -o wide.exr || echo "refused: 90 degrees"
rsm-render wide.gltf --size 8x8 --rsm-size 1 -o one.exr || echo "refused: one texel"
img-diff --crop 0,0,8,8 one.exr one.exr | grep non_finite

# Looking away.
rsm-render "$spot" $small --look-from 0,0,-50 --look-at 0,0,-100 -o nothing.exr || echo "refused: no hit"
img-diff --json nothing.exr nothing.exr | grep '"mean_image"'
ls
