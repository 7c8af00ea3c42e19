# Shards, --add and one run give the same bytes, in any order and for any number of threads.
scene=$SRC/examples/scenes/cornell_point.gltf
options=(--voxels 9x9x9 --max-depth 4 --seed 5 -q)
ls-inject "$scene" "${options[@]}" --photons 20000 -j 1 -o whole.exr || exit
for threads in 2 3 7; do
    ls-inject "$scene" "${options[@]}" --photons 20000 -j $threads -o other.exr || exit
    cmp whole.exr other.exr
done
i=0
for range in 0:1 1:4097 4097:9000 9000:15000 15000:20000; do
    i=$((i + 1))
    ls-inject "$scene" "${options[@]}" --photons $range -o shard$i.exr || exit
done
ls-inject "$scene" "${options[@]}" --photons 0:15000 -o first.exr || exit
ls-merge first.exr shard5.exr -o two.exr && cmp whole.exr two.exr
ls-merge shard5.exr first.exr -o two.exr && cmp whole.exr two.exr
ls-merge shard4.exr shard2.exr shard5.exr shard1.exr shard3.exr -o five.exr && cmp whole.exr five.exr
ls-inject "$scene" "${options[@]}" --photons 15000:20000 --add first.exr -o added.exr &&
    cmp whole.exr added.exr
# --stats are those of the photons that were traced
ls-inject "$scene" "${options[@]}" --photons 15000:20000 -o alone.exr --stats alone.json
ls-inject "$scene" "${options[@]}" --photons 15000:20000 --add first.exr -o added.exr --stats added.json
diff <(sed -n '/"result"/,$p' alone.json) <(sed -n '/"result"/,$p' added.json)

# The same with a blur, which is part of the cache.
options=(--voxels 5x4x6 --max-depth 4 -q --blur 0.5vox)
ls-inject "$scene" "${options[@]}" --photons 5000 -j 1 -o blurred.exr || exit
ls-inject "$scene" "${options[@]}" --photons 0:2000 -j 2 -o shard6.exr || exit
ls-inject "$scene" "${options[@]}" --photons 2000:5000 -j 3 --add shard6.exr -o added.exr && cmp blurred.exr added.exr
ls-inject "$scene" --voxels 5x4x6 --max-depth 4 -q --photons 5000:6000 -o sharp.exr || exit
ls-merge blurred.exr sharp.exr -o bad.exr
echo "exit $?"

# Photons that are in both, and caches of another run, are refused.
ls-merge whole.exr shard2.exr -o bad.exr
echo "exit $?"
ls-inject "$scene" --voxels 9x9x9 --max-depth 4 --seed 6 -q --photons 30000:30010 -o seed.exr
ls-merge whole.exr seed.exr -o bad.exr
echo "exit $?"
[ ! -e bad.exr ]
