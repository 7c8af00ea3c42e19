# Several frames in one run: a row each, one table of tiles, limits for each frame
for frame in 3 4; do
    "$SRC/tests/cli/make_image" "a.000$frame.exr" 16x8 R=$frame G=2 B=2
done
"$SRC/tests/cli/make_image" b.exr 16x8 R=2 G=2 B=2
img-diff --frames 3-4 --csv a.%04d.exr b.exr | cut -d, -f1-4
img-diff --frames 3-4 a.%04d.exr b.exr | grep -E '^(frame|mse)'
img-diff --frames 3-4 --json --stats stats.json a.%04d.exr b.exr |
    python3 -c 'import json, sys; print([(d["frame"], d["image"], d["max_abs"]) for d in json.load(sys.stdin)])'
python3 -c 'import json; print([d["max_abs"] for d in json.load(open("stats.json"))["result"]["frames"]])'
img-diff -q --frames 3-4 --tiles tiles.csv --tile 12 --sigma 0 a.%04d.exr b.exr --heatmap heat.%04d.png >/dev/null
cat tiles.csv
ls heat.*.png
img-diff --frames 3-4 --max-abs 1.5 a.%04d.exr b.exr >/dev/null 2>limits.txt || echo "exit $?"
cat limits.txt
img-diff --frames 3-4 b.exr b.exr 2>&1 || echo "exit $?"
img-diff --frames 3-4 --identical b.exr b.exr 2>&1 || echo "exit $?"
