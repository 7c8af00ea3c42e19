#include "metrics/error.h"

#include "base/error.h"
#include "metrics/false_color.h"
#include "metrics/sum.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ql {
namespace {

Array2D<float> constant(int width, int height, float value) {
    return {width, height, value};
}

Array2D<float> noise(int width, int height, unsigned seed) {
    Array2D<float> image(width, height);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    for (float& value : image.values())
        value = normal(random);
    return image;
}

ErrorFigures figures(const Array2D<float>& image, const Array2D<float>& reference,
                     const ErrorConfig& config = {}, int threads = 1) {
    const ChannelPair pair{&image, &reference};
    return error_figures(std::span(&pair, 1), config, Workers(threads));
}

TEST(Sum, KeepsWhatAPlainSumLoses) {
    Sum sum;
    sum.add(1e100);
    sum.add(1);
    sum.add(-1e100);
    EXPECT_EQ(sum.value(), 1);
    Sum tenths;
    for (int i = 0; i < 1'000'000; ++i)
        tenths.add(0.1);
    EXPECT_DOUBLE_EQ(tenths.value(), 100000);
    Sum infinite;
    infinite.add(1);
    infinite.add(INFINITY);
    EXPECT_EQ(infinite.value(), INFINITY);
}

TEST(ErrorFigures, OfEqualImagesAreZero) {
    const auto image = noise(37, 21, 1);
    const ErrorFigures f = figures(image, image);
    EXPECT_EQ(f.mse, 0);
    EXPECT_EQ(f.relmse, 0);
    EXPECT_EQ(f.block_relmse, 0);
    EXPECT_EQ(f.max_abs, 0);
    EXPECT_EQ(f.mean_ratio, 1);
    EXPECT_EQ(f.psnr_db, INFINITY);
    EXPECT_EQ(f.perceptual.at(0).mse, 0);
    EXPECT_EQ(f.samples, 37u * 21u);
}

TEST(ErrorFigures, OfAConstantOffsetFollowTheFormulas) {
    const ErrorFigures f = figures(constant(19, 11, 2.5f), constant(19, 11, 2));
    EXPECT_DOUBLE_EQ(f.mse, 0.25);
    EXPECT_DOUBLE_EQ(f.rmse, 0.5);
    EXPECT_DOUBLE_EQ(f.relmse, 0.25 / (4 + 0.04));
    EXPECT_DOUBLE_EQ(f.block_relmse, 0.25 / (4 + 0.04));
    EXPECT_DOUBLE_EQ(f.mean_ratio, 1.25);
    EXPECT_NEAR(f.psnr_db, 10 * std::log10(1 / 0.25), 1e-12);
    EXPECT_DOUBLE_EQ(f.max_abs, 0.5);
    EXPECT_NEAR(f.perceptual.at(0).mse, 0.25, 1e-7); // a filter keeps constants, at borders too
}

TEST(ErrorFigures, EqualAPlainLoopOverTwoChannels) {
    const auto i0 = noise(13, 9, 1), r0 = noise(13, 9, 2), i1 = noise(13, 9, 3),
               r1 = noise(13, 9, 4);
    const std::vector<ChannelPair> pairs = {{&i0, &r0}, {&i1, &r1}};
    const ErrorFigures f = error_figures(pairs, {}, Workers(2));
    double mean = 0, square = 0, relative = 0, largest = 0;
    for (const auto& [i, r] : pairs)
        for (const float value : r->values())
            mean += double(value) / (2 * 13 * 9);
    for (const auto& [i, r] : pairs)
        for (size_t p = 0; p < i->size(); ++p) {
            const double e = double((*i)[p]) - double((*r)[p]);
            square += e * e;
            relative += e * e / (double((*r)[p]) * double((*r)[p]) + 0.01 * mean * mean);
            largest = std::max(largest, std::abs(e));
        }
    EXPECT_NEAR(f.mean_reference, mean, 1e-12);
    EXPECT_NEAR(f.mse, square / (2 * 13 * 9), 1e-12);
    EXPECT_NEAR(f.relmse / (relative / (2 * 13 * 9)), 1, 1e-12);
    EXPECT_EQ(f.max_abs, largest);
}

TEST(ErrorFigures, BlocksSeeBiasAndNotNoise) {
    // +1 and -1 in a checkerboard: no mean in any block of even size
    Array2D<float> image(16, 16, 1);
    for (int y = 0; y < 16; ++y)
        for (int x = 0; x < 16; ++x)
            image(x, y) += (x + y) % 2 ? 0.5f : -0.5f;
    const ErrorFigures f = figures(image, constant(16, 16, 1));
    EXPECT_NEAR(f.relmse, 0.25 / 1.01, 1e-12);
    EXPECT_NEAR(f.block_relmse, 0, 1e-24);
}

TEST(ErrorFigures, PartialBlocksWeighTheirSamples) {
    // 9 x 8: one whole block without error, one column with error 1
    Array2D<float> image(9, 8, 1);
    for (int y = 0; y < 8; ++y)
        image(8, y) = 2;
    const ErrorFigures f = figures(image, constant(9, 8, 1));
    EXPECT_NEAR(f.block_relmse, (8.0 / 72.0) * 1 / 1.01, 1e-12);
}

TEST(ErrorFigures, BlackReferencesGiveDefinedFigures) {
    const ErrorFigures same = figures(constant(4, 4, 0), constant(4, 4, 0));
    EXPECT_EQ(same.relmse, 0);
    EXPECT_EQ(same.mean_ratio, 1);
    const ErrorFigures other = figures(constant(4, 4, 1), constant(4, 4, 0));
    EXPECT_EQ(other.relmse, INFINITY);
    EXPECT_EQ(other.mean_ratio, INFINITY);
}

TEST(ErrorFigures, NonFiniteSamplesAreCountedAndLeftOut) {
    auto image = constant(10, 10, 1), reference = constant(10, 10, 1);
    image(0, 0) = NAN;
    image(3, 0) = INFINITY;
    reference(3, 0) = -INFINITY; // the same sample counts once
    reference(9, 9) = NAN;
    const ErrorFigures f = figures(image, reference);
    EXPECT_EQ(f.non_finite, 3u);
    EXPECT_EQ(f.samples, 97u);
    EXPECT_EQ(f.mse, 0);
    EXPECT_EQ(f.perceptual.at(0).mse, 0);
    const ErrorFigures none = figures(constant(2, 2, NAN), constant(2, 2, 1));
    EXPECT_EQ(none.non_finite, 4u);
    EXPECT_EQ(none.samples, 0u);
}

TEST(ErrorFigures, WithoutABlurThePerceptualErrorIsTheMse) {
    Array2D<float> image = noise(8, 8, 1);
    image[3] = INFINITY;
    image[20] = NAN;
    ErrorConfig config;
    config.sigmas_px = {0};
    const ErrorFigures found = figures(image, constant(8, 8, 0), config);
    EXPECT_EQ(found.non_finite, 2u);
    EXPECT_NEAR(found.perceptual.at(0).mse / found.mse, 1, 1e-9);
}

TEST(ErrorFigures, DoNotDependOnTheThreadCount) {
    const auto image = noise(301, 203, 5), reference = noise(301, 203, 6);
    ErrorConfig config;
    config.sigmas_px = {0.7, 3};
    const ErrorFigures one = figures(image, reference, config, 1);
    for (int threads : {2, 4}) {
        const ErrorFigures f = figures(image, reference, config, threads);
        EXPECT_EQ(f.mse, one.mse);
        EXPECT_EQ(f.relmse, one.relmse);
        EXPECT_EQ(f.block_relmse, one.block_relmse);
        EXPECT_EQ(f.perceptual.at(1).mse, one.perceptual.at(1).mse);
    }
}

TEST(ErrorFigures, OfWhiteNoiseBehindAGaussianAreThoseOfTheory) {
    // Variance 1 / (4 pi sigma^2); its relative standard error is about sqrt(4 pi sigma^2 2 / n)
    const auto image = noise(512, 512, 9), zero = constant(512, 512, 0);
    ErrorConfig config;
    config.sigmas_px = {0, 1, 2};
    config.border = Border::wrap;
    const ErrorFigures f = figures(image, zero, config);
    EXPECT_DOUBLE_EQ(f.perceptual.at(0).mse, f.mse);
    EXPECT_NEAR(f.perceptual.at(1).mse * 4 * M_PI, 1, 0.04);
    EXPECT_NEAR(f.perceptual.at(2).mse * 16 * M_PI, 1, 0.08);
}

TEST(ErrorFigures, RefuseSenselessSettings) {
    const auto image = constant(2, 2, 1);
    EXPECT_THROW(figures(image, image, {.sigmas_px = {-1}}), Error);
    EXPECT_THROW(figures(image, image, {.sigmas_px = {NAN}}), Error);
    EXPECT_THROW(figures(image, image, {.block_px = 0}), Error);
    EXPECT_THROW(figures(image, image, {.peak = 0}), Error);
    EXPECT_THROW(figures(image, constant(2, 3, 1)), Error);
}

TEST(RelativeError, IsTheRootOfEachPixelsShareInRelmse) {
    const auto image = noise(16, 16, 1), reference = noise(16, 16, 2);
    const ChannelPair pair{&image, &reference};
    double sum = 0;
    for (const float e : relative_error(std::span(&pair, 1), Workers(1)).values())
        sum += double(e) * double(e);
    EXPECT_NEAR(sum / 256 / figures(image, reference).relmse, 1, 1e-5);
}

TEST(RelativeError, IsNotANumberWhereASampleIsNotFinite) {
    Array2D<float> image = constant(3, 1, 1);
    image[0] = INFINITY;
    image[1] = NAN;
    const Array2D<float> reference = constant(3, 1, 1);
    const ChannelPair pair{&image, &reference};
    const Array2D<float> error = relative_error(std::span(&pair, 1), Workers(1));
    EXPECT_TRUE(std::isnan(error[0]));
    EXPECT_TRUE(std::isnan(error[1]));
    EXPECT_EQ(error[2], 0);
}

TEST(FalseColor, RisesInLightness) {
    float last = -1;
    for (int i = 0; i <= 100; ++i) {
        const Imath::V3f color = false_color(float(i) / 100);
        const float grey = 0.2126f * color.x + 0.7152f * color.y + 0.0722f * color.z;
        EXPECT_GT(grey, last) << i;
        last = grey;
    }
    EXPECT_EQ(false_color(-INFINITY), Imath::V3f(0));
    EXPECT_EQ(false_color(INFINITY), Imath::V3f(1));
    EXPECT_EQ(false_color(NAN), Imath::V3f(0, 1, 0));
}

} // namespace
} // namespace ql
