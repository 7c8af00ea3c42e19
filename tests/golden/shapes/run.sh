bn-render "$SRC/examples/scenes/shapes.gltf" --size 64x64 --spp 16 -o image.exr
