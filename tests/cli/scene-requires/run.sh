# What a scene does not need is neither built nor run, and --stats shows it.
scenes=$SRC/examples/scenes

# holds STATS EXPRESSION: Python over s, the object of --stats
holds() {
    python3 -c 'import json, sys
s = json.load(open(sys.argv[1]))
if not eval(sys.argv[2]): print(f"{sys.argv[1]}: not {sys.argv[2]}: {s}")' "$1" "$2"
}

# Kernels: a scene of diffuse walls runs the smallest one, glass the general one; textures that no
# material uses are not read
bn-render "$scenes/cornell_point.gltf" --size 8x8 -o a.exr --stats diffuse.json
holds diffuse.json 's["scene"]["kernel"] == "diffuse" and s["scene"]["textures"] == 0'
bn-render "$scenes/cornell_glass.gltf" --size 8x8 -o a.exr --stats glass.json
holds glass.json 's["scene"]["kernel"] == "all lobes"'
"$SRC/tests/cli/make_image" texture.png 1x1 R=200 G=150 B=100
python3 - "$scenes/cornell_point.gltf" <<'PYTHON'
import json, sys
scene = json.load(open(sys.argv[1]))
texel = "texture.png"
json.dump({**scene, "images": [{"uri": texel}], "textures": [{"source": 0}]}, open("unused.gltf", "w"))
scene["images"], scene["textures"] = [{"uri": texel}], [{"source": 0}]
scene["materials"][0] = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}
json.dump(scene, open("textured.gltf", "w"))
PYTHON
bn-render unused.gltf -q --size 8x8 -o a.exr --stats unused.json
holds unused.json 's["scene"]["textures"] == 0'
bn-render textured.gltf -q --size 8x8 -o a.exr --stats textured.json
holds textured.json 's["scene"]["textures"] == 1'

# Rays: without lights no shadow rays; at depth 1 of a scene of lamps none but those and the camera's
bn-render "$scenes/cornell_point.gltf" --size 8x8 --max-depth 1 -o a.exr --stats direct.json
holds direct.json 's["rays"]["indirect"] == 0 and s["rays"]["camera"] == 64 and s["rays"]["shadow"] <= 64'
python3 - "$scenes/cornell_point.gltf" <<'PYTHON'
import json, sys
scene = json.load(open(sys.argv[1]))
lamps = scene["extensions"]["KHR_lights_punctual"]["lights"]
node = next(n for n in scene["nodes"] if "extensions" in n)
lamps += [dict(lamps[0]), {**lamps[0], "intensity": 0}]
for light in (1, 2):
    scene["nodes"].append({**node, "extensions": {"KHR_lights_punctual": {"light": light}}})
    scene["scenes"][0]["nodes"].append(len(scene["nodes"]) - 1)
json.dump(scene, open("three.gltf", "w"))
scene["nodes"] = [n for n in scene["nodes"] if "mesh" in n or "camera" in n]
scene["scenes"][0]["nodes"] = list(range(len(scene["nodes"])))
json.dump(scene, open("dark.gltf", "w"))
PYTHON
bn-render dark.gltf --allow-dark --size 8x8 -o a.exr --stats dark.json
holds dark.json 's["rays"]["shadow"] == 0'

# Maps: one for a light, none for a lamp that is off
rsm-render "$scenes/cornell_point.gltf" --size 8x8 --rsm-size 8 --samples 2 -o a.exr --stats one.json
holds one.json 'len(s["result"]["maps"]) == 1 and s["rays"]["map"] == 64 and s["config"]["spp"] == 4'
rsm-render three.gltf --size 8x8 --rsm-size 8 --samples 2 -o a.exr --stats three.json
holds three.json 'len(s["result"]["maps"]) == 2'

# Caches: memory goes by the shafts with light, and dark voxels take none
ls-inject "$scenes/cornell_point.gltf" --photons 200 --voxels 16x16x16 -o small.exr --stats few.json
ls-inject "$scenes/cornell_point.gltf" --photons 20000 --voxels 16x16x16 -o large.exr --stats many.json
ls-inject --info small.exr --stats info.json >/dev/null
holds info.json '0 < s["result"]["filled_voxels"] < s["result"]["voxels"] // 2'
holds few.json 's["result"]["shafts"] <= 3 * s["result"]["deposits"]'
holds few.json 's["result"]["groups"] <= 2 * s["result"]["shafts"]'
holds few.json 's["result"]["cache_memory_bytes"] == 16 * (16 ** 3 + 1) + 36 * s["result"]["shafts"] + 8 * s["result"]["groups"]'
[ $(($(stat -c %s large.exr) / $(stat -c %s small.exr))) -ge 4 ] || echo "a cache of a hundredth of the photons is as large"

# Positions in the next frame only for motion
bn-render "$scenes/cornell_moving_block.gltf" --size 8x8 --frames 0-2 -o a.%04d.exr --stats still.json
holds still.json 's["result"]["motion_transforms"] == 0'
bn-render "$scenes/cornell_moving_block.gltf" --size 8x8 --frames 0-2 --aov motion -o a.%04d.exr --stats moving.json
holds moving.json 's["result"]["motion_transforms"] == 3'

# Candidate lists and channels only where they are asked for
ls-sample "$scenes/cornell_point.gltf" --cache small.exr --size 8x8 -o a.exr --stats read.json
holds read.json '"candidates" not in s["result"]'
bn-render "$scenes/cornell_moving_block.gltf" --size 8x8 -o plain.exr
bn-render "$scenes/cornell_moving_block.gltf" --size 8x8 --aov motion -o moving.exr
[ "$(stat -c %s plain.exr)" -lt "$(stat -c %s moving.exr)" ] || echo "channels that nobody asked for"
