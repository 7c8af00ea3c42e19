// The blueness of void-and-cluster masks, as thresholded patterns after a filter: Donnelly et al.
// 2024 (FAST), Heaviside RMS over the thresholds k/128. White noise: 0.116 for this filter.
#include "bluenoise/mask.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ql {
namespace {

std::vector<double> gaussian(double sigma_px) {
    const int radius = int(std::ceil(5 * sigma_px));
    std::vector<double> kernel;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i)
        sum += kernel.emplace_back(std::exp(-i * i / (2 * sigma_px * sigma_px)));
    for (double& weight : kernel)
        weight /= sum;
    return kernel;
}

Array2D<double> filtered_rows_transposed(const Array2D<double>& in,
                                         const std::vector<double>& kernel) {
    Array2D<double> out(in.height(), in.width());
    for (int y = 0; y < in.height(); ++y)
        for (int x = 0; x < in.width(); ++x) {
            double sum = 0;
            for (int i = 0; i < int(kernel.size()); ++i)
                sum += kernel[size_t(i)] * in(wrap(x + i, in.width()), y);
            out(y, x) = sum;
        }
    return out;
}

double heaviside_rms(const Array2D<uint32_t>& ranks, const std::vector<double>& kernel) {
    double sum = 0;
    for (int k = 1; k < 128; ++k) {
        Array2D<double> error(ranks.width(), ranks.height());
        for (size_t i = 0; i < ranks.size(); ++i)
            error[i] = (ranks[i] < ranks.size() * size_t(k) / 128 ? 1.0 : 0.0) - k / 128.0;
        error = filtered_rows_transposed(filtered_rows_transposed(error, kernel), kernel);
        for (const double e : error.values())
            sum += e * e;
    }
    return std::sqrt(sum / 127 / double(ranks.size()));
}

double mean_rms(MaskMethod method, const std::vector<double>& kernel, uint64_t seeds) {
    double sum = 0;
    for (uint64_t seed = 0; seed < seeds; ++seed) {
        MaskConfig config;
        config.method = method;
        config.width = config.height = 128;
        config.sigma_px = 1.2;
        config.seed = seed;
        Progress progress;
        sum += heaviside_rms(mask_ranks(config, progress), kernel);
    }
    return sum / double(seeds);
}

TEST(BluenoiseMask, Sigma12IsBluerThanTheBestPublishedMask) {
    EXPECT_LT(mean_rms(MaskMethod::void_and_cluster, gaussian(1), 8), 0.0365);
}

TEST(BluenoiseMask, WhiteMasksAreWhite) {
    // sqrt(mean t (1 - t)) = sqrt(1/6) times the kernel's norm sqrt(1 / (4 pi)).
    EXPECT_NEAR(mean_rms(MaskMethod::white, gaussian(1), 4), std::sqrt(1.0 / 6 / (4 * M_PI)),
                0.004);
}

} // namespace
} // namespace ql
