# Each bad scene: one line that names the file, exit status 3, no image.
scene=$SRC/examples/scenes/cornell_point.gltf
: >empty.gltf
head -c 3000 "$scene" >truncated.gltf
echo "this is text" >text.gltf
echo '{"asset": {"version": "1.0"}}' >old.gltf
mkdir folder.gltf
sed 's/"KHR_lights_punctual": {"light"/"none": {"light"/' "$scene" |
    python3 -c "
import json, sys
scene = json.load(sys.stdin)
for node in scene['nodes']: node.pop('extensions', None)
json.dump(scene, open('dark.gltf', 'w'))"
for bad in missing empty truncated text old folder dark; do
    bn-render $bad.gltf --size 8x8 -o image.exr 2>err.txt
    [ $? = 3 ] || echo "$bad: wrong status"
    [ "$(wc -l <err.txt)" = 1 ] || echo "$bad: expected one line: $(cat err.txt)"
    grep -q "^bn-render: $bad.gltf: " err.txt || echo "$bad: $(cat err.txt)"
    [ ! -e image.exr ] || echo "$bad: left an image"
done
bn-render dark.gltf --size 8x8 --allow-dark -o dark.exr
bn-render dark.gltf --size 8x8 --sky 1,1,1 -o sky.exr
ls ./*.exr

# What a file brings into a message stays on its line, and no terminal obeys it.
sed 's/"extensionsUsed": \[/&"one\\nline\\u001b[2J", /' "$scene" >lines.gltf
bn-render lines.gltf --size 8x8 -o lines.exr 2>err.txt
grep -q '^bn-render: warning: lines.gltf: ignores the extension one line \[2J$' err.txt || cat err.txt
[ "$(wc -l <err.txt)" = 1 ] || echo "expected one line of warning"
