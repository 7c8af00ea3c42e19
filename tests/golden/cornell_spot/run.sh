bn-render "$SRC/examples/scenes/cornell_spot.gltf" --size 64x64 --spp 16 -o image.exr
