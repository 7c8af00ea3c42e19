// The sorting pass: in each block of pixels the seed of the k-th intensity goes to the pixel of the
// k-th mask value. E. Heitz and L. Belcour, "Distributing Monte Carlo errors as a blue noise in
// screen space by permuting pixel seeds between frames", CGF 38(4), 2019, algorithm 1.
//
// Blocks at the border are cut off by it. Equal intensities are put in the order of a hash of their
// seeds, equal mask values in the order of a hash of their place in the tile; by position only
// where the 18 bits of the hash agree, too. The result does not depend on the number of threads.
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <Imath/ImathVec.h>

#include <cstdint>

namespace ql {

constexpr int kMaxSortBlock = 64;

// The order of a mask's values: 0..n-1 each once, equal values in the order of a hash.
Array2D<uint32_t> unique_ranks(const Array2D<uint32_t>& values);

struct SortConfig {
    int block_px = 8;                // side of a block, [1, 64]; 1 changes nothing
    Imath::V2i origin = {0, 0};      // of the lattice of blocks, pixels
    Imath::V2i mask_offset = {0, 0}; // o(t): the mask at pixel x is ranks((x + o) mod N)
    uint32_t tie_key = 0;            // of the hash that decides between equal intensities
};

// seeds: width x height of the intensities or larger; what lies outside stays as it is.
// ranks: from unique_ranks(). surfaces: empty, or for each pixel a number; seeds are then exchanged
// between pixels of the same number only. Intensities must be finite.
void sort_seeds(Array2D<uint32_t>& seeds, const Array2D<float>& intensities,
                const Array2D<uint32_t>& ranks, const Array2D<uint32_t>& surfaces,
                const SortConfig& config, const Workers& workers);

} // namespace ql
