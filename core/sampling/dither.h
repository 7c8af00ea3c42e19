// Blue-noise dithered sampling: every pixel takes the same random numbers, each shifted by a mask.
//
// I. Georgiev and M. Fajardo, "Blue-noise dithered sampling", SIGGRAPH Talks 2016. The shift is a
// rotation of the unit circle (Cranley and Patterson 1976), here an addition of 32-bit words. Each
// dimension reads the mask at a place of its own, along the R2 sequence (M. Roberts 2018), so that
// dimensions are not correlated. Thread safe: const.
#pragma once

#include "base/array2d.h"
#include "sampling/r2.h"
#include "sampling/random.h"

#include <cstdint>

namespace ql {

struct DitherTile {
    Array2D<uint32_t> shifts; // mask values as fractions of 2^32
    int offset_x = 0;         // of the mask in this frame, pixels
    int offset_y = 0;
    uint32_t sequence = 0; // key of the numbers that all pixels of the frame share
};

class DitheredRandom {
  public:
    DitheredRandom(const DitherTile& tile, int x, int y, uint32_t sample)
        : m_tile(tile), m_x(x + tile.offset_x), m_y(y + tile.offset_y),
          m_shared(tile.sequence, sample) {}

    RandomWords words(uint32_t dimension_block) const {
        RandomWords words = m_shared.words(dimension_block);
        for (uint32_t i = 0; i < 4; ++i)
            words[i] += shift(4 * dimension_block + i);
        return words;
    }
    RandomFloats block(uint32_t dimension_block) const {
        return unit_floats(words(dimension_block));
    }

  private:
    uint32_t shift(uint32_t dimension) const {
        const uint32_t rx = dimension * kR2StepX, ry = dimension * kR2StepY;
        const Array2D<uint32_t>& shifts = m_tile.shifts;
        const auto along = [](uint32_t fraction, int side) {
            return int(uint64_t(fraction) * uint64_t(side) >> 32);
        };
        return shifts(wrap(m_x + along(rx, shifts.width()), shifts.width()),
                      wrap(m_y + along(ry, shifts.height()), shifts.height()));
    }

    const DitherTile& m_tile;
    int m_x, m_y;
    PixelRandom m_shared;
};

} // namespace ql
