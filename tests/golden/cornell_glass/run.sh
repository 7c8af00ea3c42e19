bn-render "$SRC/examples/scenes/cornell_glass.gltf" --size 64x64 --spp 16 --max-depth 8 -o image.exr
