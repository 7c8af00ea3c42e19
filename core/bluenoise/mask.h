// Threshold masks: tiles of ranks 0..n-1, each exactly once, that repeat without a seam.
//
// Sources: void-and-cluster, Ulichney 1993 (void_and_cluster.h); the ordered matrix of B. E. Bayer,
// "An optimum method for two-level rendition of continuous-tone pictures", ICC 1973. The threshold
// that a rank r of n stands for is (r + 0.5) / n. Pure functions of the configuration.
#pragma once

#include "base/array2d.h"
#include "base/progress.h"

#include <cstdint>

namespace ql {

enum class MaskMethod { void_and_cluster, white, bayer };

struct MaskConfig {
    MaskMethod method = MaskMethod::void_and_cluster;
    int width = 64; // pixels; at most 2^24 pixels in all; powers of two for Bayer
    int height = 64;
    double sigma_px = 1.5; // of the Gaussian that spreads energy, [0.3, 8]; void-and-cluster only
    uint64_t seed = 0;     // not for Bayer, of which there is only one
    uint32_t channel = 0;  // channels of one seed are independent masks
};

// Errors: ErrorKind::usage for a size, sigma or method that does not go.
void check_mask_config(const MaskConfig& config);

// What mask_ranks() takes at most, result included.
size_t mask_memory_bytes(const MaskConfig& config);

// The rank of each pixel.
Array2D<uint32_t> mask_ranks(const MaskConfig& config, Progress& progress);

} // namespace ql
