# Every channel is there and --stats counts the rays.
set -eu
scene=$SRC/examples/scenes/cornell_point.gltf
bn-render "$scene" --size 32x32 --spp 2 --aov all --stats stats.json -o image.exr
python3 - <<'PYTHON'
import json
stats = json.load(open("stats.json"))
assert stats["rays"]["camera"] == 32 * 32 * 2, stats["rays"]
assert stats["rays"]["shadow"] > 0 and stats["rays"]["indirect"] > 0
assert stats["discarded_samples"] == 0
print(stats["scene"]["kernel"])
data = open("image.exr", "rb").read()
for name in ("B G R Z id N.X N.Y N.Z P.X P.Y P.Z albedo.R motion.X motion.Y direct.G indirect.B "
             "variance.R worldToCamera worldToNDC ql:spp ql:max_depth ql:seed ql:frame").split():
    assert name.encode() + b"\0" in data, name
PYTHON
