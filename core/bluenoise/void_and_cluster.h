// The void-and-cluster method: a threshold mask whose every threshold is a blue-noise pattern.
//
// Source: R. Ulichney, "The void-and-cluster method for dither array generation", SPIE 1913, 1993.
// All three phases, on the torus, for any size. The Gaussian is cut off at 5 sigma and kept in
// integers (units of 2^-24), so that energies are exact: no drift, and the same mask from every
// compiler. Cost: O(n (k + log n)) for n pixels and k kernel entries. One instance per thread.
#pragma once

#include "base/array2d.h"
#include "base/progress.h"

#include <cstdint>
#include <vector>

namespace ql {

constexpr size_t kMaxMaskPixels = size_t(1) << 24;

// The toroidal Gaussian in units of 2^-24, folded where it is wider than the tile.
// Entry (i, j) belongs to the offset (i - width / 2, j - height / 2).
Array2D<int64_t> toroidal_gaussian(int width, int height, double sigma_px);

// Ranks 0..n-1, each once. `priority` is a permutation of 0..n-1: its first tenth is the initial
// pattern, and of several equal voids or clusters it decides (lower: void; higher: cluster).
// Reports one step of progress per rank. sigma_px in [0.3, 8].
Array2D<uint32_t> void_and_cluster(int width, int height, double sigma_px,
                                   const std::vector<uint32_t>& priority, Progress& progress);

} // namespace ql
