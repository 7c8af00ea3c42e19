# Wrong options: one line each, exit status 2.
scene=$SRC/examples/scenes/cornell_point.gltf
try() { "$@"; echo "exit $?"; }
try ls-inject
try ls-inject "$scene"
try ls-inject "$scene" --voxels 4x4 -o a.exr
try ls-inject "$scene" --voxels 0x4x4 -o a.exr
try ls-inject "$scene" --voxels 4x4x16385 -o a.exr
try ls-inject "$scene" --photons 5:5 -o a.exr
try ls-inject "$scene" --photons 1.5 -o a.exr
try ls-inject "$scene" --voxel-size 1e-9 -o a.exr
try ls-inject "$scene" --max-depth 1 -o a.exr
try ls-inject "$SRC/examples/scenes/cornell_area.gltf" --estimator count-text -q -o a.exr
ls-inject "$scene" --photons 1000 --voxels 4x4x4 --max-depth 3 -o c.exr
try ls-sample "$scene" -o a.exr
try ls-sample "$scene" --cache c.exr --max-depth 4 -o a.exr
try ls-sample "$scene" --cache c.exr --fallback trace -o a.exr
try ls-sample "$scene" --cache c.exr --blur 3furlong -o a.exr
try ls-inject "$scene" --estimator count-text --blur 0.25vox -q -o a.exr
try ls-sample "$scene" --cache c.exr --occlusion candidates --blur 0.1 -o a.exr
try ls-sample "$scene" --cache c.exr --layers red -o a.exr
try ls-sample "$scene" --cache c.exr --glossy 5 2 -o a.exr
try ls-inject "$scene" --max-depth 801 -o a.exr
try ls-inject "$scene" --estimator count-text --branches 8 -q -o a.exr
try ls-inject "$scene" -o a.png
try ls-merge c.exr -o a.png
# What cannot be added is refused before anything is traced
try ls-inject "$scene" --photons 1e12 --voxels 4x4x4 --max-depth 3 --add missing.exr -o a.exr
try ls-inject "$scene" --photons 500:1000000000000 --voxels 4x4x4 --max-depth 3 --add c.exr -o a.exr
[ ! -e a.exr ]
