bn-render "$SRC/examples/scenes/cornell_phong.gltf" --size 64x64 --spp 16 -o image.exr
