// How far an image I is from a reference R.
//
// Sums run over pixels and the given channels alike, in double and in a fixed order (the thread
// count changes nothing). A sample that is not finite in either image is counted and left out of
// every figure, so that the figures stay readable; a comparison that has one must be failed.
//
//   mse           mean((I - R)^2); rmse is its root
//   relmse        mean((I - R)^2 / (R^2 + 0.01 mean(R)^2))
//   mean_ratio    mean(I) / mean(R): bias of the brightness
//   block_relmse  the same as relmse of the means of I and R over 8 x 8 blocks (bias without most
//                 of the noise). Blocks are cut at the right and lower border; each block weighs
//                 as many samples as it has.
//   psnr_db       10 log10(peak^2 / mse)
//   max_abs       the largest |I - R|
//   perceptual    mse of I - R after a Gaussian of sigma pixels (Chizhov et al. 2022, "Perceptual
//                 error optimization for Monte Carlo rendering", section 3), mirrored at the border
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"
#include "image/image.h"
#include "metrics/filter.h"

#include <cstdint>
#include <span>
#include <vector>

namespace ql {

struct ErrorConfig {
    std::vector<double> sigmas_px = {1.0}; // of the perceptual error, each in [0, 1000]
    int block_px = 8;                      // side of a block, at least 1
    double peak = 1.0;                     // of psnr_db, above 0
    Border border = Border::mirror;        // of the perceptual error
};

struct PerceptualError {
    double sigma_px = 0;
    double mse = 0;
};

struct ErrorFigures {
    uint64_t samples = 0;    // compared, without the non-finite ones
    uint64_t non_finite = 0; // left out
    double mean_image = 0;
    double mean_reference = 0;
    double mean_ratio = 0; // 1 if both means are 0
    double mse = 0;
    double rmse = 0;
    double relmse = 0; // infinite if an error stands over a denominator of 0
    double block_relmse = 0;
    double psnr_db = 0; // infinite for equal images
    double max_abs = 0;
    std::vector<PerceptualError> perceptual; // in the order of sigmas_px
};

// One channel of both images.
struct ChannelPair {
    const Array2D<float>* image = nullptr;
    const Array2D<float>* reference = nullptr;
};

// All planes are of the same size. At least one channel.
ErrorFigures error_figures(std::span<const ChannelPair> channels, const ErrorConfig& config,
                           const Workers& workers);

// Per pixel sqrt(mean over channels of (I - R)^2 / (R^2 + 0.01 mean(R)^2)), for heat maps; NaN
// where a channel is not finite.
Array2D<float> relative_error(std::span<const ChannelPair> channels, const Workers& workers);

// Samples of float and unsigned planes that are not the same bit for bit, of images with the same
// size and the same channels in the same order.
size_t differing_samples(const Image& image, const Image& reference);

} // namespace ql
