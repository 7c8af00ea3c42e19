# Damaged, foreign and hostile caches: one line, exit status 3, nothing written.
scene=$SRC/examples/scenes/cornell_point.gltf
ls-inject "$scene" --photons 3000 --voxels 5x5x5 -o c.exr || exit
"$SRC/tests/cli/make_image" flat.exr 4x4 R=0 G=0 B=0
: >empty.exr
python3 - <<'END'
import random
data = open('c.exr', 'rb').read()
random.seed(1)
n = 0
def put(b):
    global n
    open('bad%d.exr' % n, 'wb').write(b)
    n += 1
for i in range(2):
    put(data[:random.randrange(len(data))])
for i in range(6):
    b = bytearray(data)
    at = random.randrange(1500) if i % 2 else random.randrange(len(data))
    b[at] ^= 1 << random.randrange(8)
    put(bytes(b))
# Attributes that lie.
def patched(key, value):
    b = bytearray(data)
    at = b.index(key) + len(key)
    at = b.index(b'\0', at + 1) + 5
    b[at:at + len(value)] = value
    put(bytes(b))
import struct
for key in (b'ql:voxels_x\0', b'ql:voxels_y\0', b'ql:patches\0', b'ql:version\0', b'ql:sum_bits\0'):
    for value in (0, 2**31 - 1):
        patched(key, struct.pack('<i', value))
patched(b'ql:unit\0', struct.pack('<d', float('nan')))
patched(b'ql:voxel_size\0', struct.pack('<d', float('nan')))
patched(b'ql:grid_lower\0', struct.pack('<d', float('inf')))
patched(b'dataWindow\0', struct.pack('<iiii', 0, 0, 2**31 - 2, 2**31 - 2))
END
ls-sample "$scene" --cache c.exr --size 4x4 -o good.exr || exit
for bad in flat.exr empty.exr missing.exr bad*.exr; do
    ls-sample "$scene" --cache $bad --size 4x4 -o a.exr >out.txt 2>err.txt
    status=$?
    # Bits that carry nothing (line order, window of the screen) may differ: then the image is right.
    case $bad in
        bad[2-7].exr) [ $status = 0 ] && cmp -s a.exr good.exr && rm a.exr && continue ;;
    esac
    [ $status = 3 ] || { echo "$bad: exit status $status, expected 3"; cat err.txt; }
    [ "$(wc -l <err.txt)" = 1 ] || { echo "$bad: not one line:"; cat err.txt; }
done
[ ! -e a.exr ] || echo "a.exr was written"
