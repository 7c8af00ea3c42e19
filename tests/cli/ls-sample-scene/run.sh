# A cache belongs to a scene; --any-scene and --info do not mind.
scenes=$SRC/examples/scenes
ls-inject "$scenes/cornell_point.gltf" --photons 2000 --voxels 5x5x5 -o c.exr
ls-sample "$scenes/cornell_mirror.gltf" --cache c.exr --size 8x8 -o a.exr
echo "exit $?"
[ ! -e a.exr ] || echo "a.exr was written"
ls-sample "$scenes/cornell_mirror.gltf" --cache c.exr --any-scene --size 8x8 -o a.exr
echo "exit $?"
ls-sample "$scenes/cornell_point.gltf" --cache c.exr --size 16x16 --spp 2 --layers all -o b.exr
ls-sample "$scenes/cornell_point.gltf" --cache c.exr --size 16x16 --spp 2 --layers all -j 3 -o d.exr
cmp b.exr d.exr
ls-inject --info c.exr | sed 's/[0-9a-f]\{16\}/HASH/'
exrheader c.exr | grep -c ql:
