#!/usr/bin/env python3
"""toy.py IMAGE [--seeds FILE] [--fresh N] [--seeds-out FILE] [--spp N] [--size N]: a renderer that is
not ours. A ball on a floor below a square lamp, one shadow ray a sample; all random numbers of a
pixel follow from its seed, and from nothing else. Standard library only."""
import argparse
import array
import math
import random
import struct
import zlib


def read_seeds(path, size):
    """Channel `seed` (UINT) of a scan-line EXR of that one channel, as bn-permute writes it."""
    data, at, header = open(path, "rb").read(), 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        length, = struct.unpack_from("<i", data, at)
        header[name] = data[at + 4:at + 4 + length]
        at += 4 + length
    _, _, right, bottom = struct.unpack("<4i", header[b"dataWindow"])
    lines, width, rows = {0: 1, 2: 1, 3: 16}[header[b"compression"][0]], right + 1, []
    for block in range(-(-(bottom + 1) // lines)):
        offset, = struct.unpack_from("<Q", data, at + 1 + 8 * block)
        packed = data[offset + 8:offset + 8 + struct.unpack_from("<i", data, offset + 4)[0]]
        count = min(lines, bottom + 1 - block * lines) * width
        if len(packed) < 4 * count:  # ZIP: differences of bytes, even ones first
            raw = bytearray(zlib.decompress(packed))
            for i in range(1, len(raw)):
                raw[i] = (raw[i] + raw[i - 1] - 128) & 255
            half, packed = (len(raw) + 1) // 2, bytearray(len(raw))
            packed[0::2], packed[1::2] = raw[:half], raw[half:]
        values = array.array("I", bytes(packed))
        rows += [values[i:i + width] for i in range(0, count, width)]
    return [row[:size] for row in rows[:size]]


def write_exr(path, channel, kind, rows):
    """One channel, kind I (UINT) or f (FLOAT), without compression."""
    size = len(rows)
    box = struct.pack("<4i", 0, 0, size - 1, size - 1)
    listed = channel + b"\0" + struct.pack("<iB3xii", "I_f".index(kind), 0, 1, 1) + b"\0"
    head = struct.pack("<ii", 20000630, 2) + b"".join(
        name + b"\0" + type_ + b"\0" + struct.pack("<i", len(value)) + value for name, type_, value in (
            (b"channels", b"chlist", listed), (b"compression", b"compression", b"\0"),
            (b"dataWindow", b"box2i", box), (b"displayWindow", b"box2i", box), (b"lineOrder", b"lineOrder", b"\0"),
            (b"pixelAspectRatio", b"float", struct.pack("<f", 1)), (b"screenWindowWidth", b"float", struct.pack("<f", 1)),
            (b"screenWindowCenter", b"v2f", struct.pack("<2f", 0, 0)))) + b"\0"
    with open(path, "wb") as out:
        out.write(head + struct.pack(f"<{size}Q", *(len(head) + 8 * size + y * (8 + 4 * size) for y in range(size))))
        for y, row in enumerate(rows):
            out.write(struct.pack(f"<ii{size}{kind}", y, 4 * size, *row))


def light_at(x, y, draw):
    """Radiance of the floor at x, y: one point of the lamp, 2 above, behind a ball of radius 1/4."""
    lx, ly, lz = draw() - 0.5 - x, draw() - 0.5 - y, 2.0
    square = lx * lx + ly * ly + lz * lz
    bx, by, bz = -x, -y, 0.6  # the ball's centre from here
    along = (bx * lx + by * ly + bz * lz) / square
    near = (bx - along * lx) ** 2 + (by - along * ly) ** 2 + (bz - along * lz) ** 2
    return 0.0 if near < 0.0625 and 0 < along < 1 else 4 * lz * lz / (math.pi * square * square)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("image")
    parser.add_argument("--seeds")
    parser.add_argument("--fresh", type=int, default=0)
    parser.add_argument("--seeds-out")
    parser.add_argument("--spp", type=int, default=1)
    parser.add_argument("--size", type=int, default=128)
    asked = parser.parse_args()
    size = asked.size
    fresh = random.Random(asked.fresh)
    seeds = (read_seeds(asked.seeds, size) if asked.seeds else
             [[fresh.getrandbits(32) for _ in range(size)] for _ in range(size)])
    image = []
    for y in range(size):
        row = []
        for x in range(size):
            draw = random.Random(seeds[y][x]).random
            place = 2 * (x + 0.5) / size - 1, 2 * (y + 0.5) / size - 1
            row.append(sum(light_at(*place, draw) for _ in range(asked.spp)) / asked.spp)
        image.append(row)
    write_exr(asked.image, b"Y", "f", image)
    if asked.seeds_out:
        write_exr(asked.seeds_out, b"seed", "I", seeds)


main()
