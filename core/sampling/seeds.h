// The seed texture of a frame that starts afresh: every tool that makes or continues a sequence of
// frames takes the same.
#pragma once

#include "base/array2d.h"
#include "sampling/random.h"

#include <cstdint>

namespace ql {

// A hash of (seed, pixel, frame); width x height.
inline Array2D<uint32_t> fresh_seeds(uint64_t seed, int64_t frame, int width, int height) {
    Array2D<uint32_t> seeds(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            seeds(x, y) = hash32(seed, uint32_t(x), uint32_t(y), uint32_t(frame));
    return seeds;
}

} // namespace ql
