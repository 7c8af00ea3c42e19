#include "metrics/spectrum.h"

#include "metrics/filter.h"
#include "metrics/fourier.h"
#include "metrics/mask_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace ql {
namespace {

Array2D<float> noise(int width, int height, unsigned seed) {
    Array2D<float> image(width, height);
    std::mt19937 random(seed);
    std::normal_distribution<float> normal;
    for (float& value : image.values())
        value = 3 + 2 * normal(random);
    return image;
}

Spectrum spectrum_of(const Array2D<float>& image, Window window = Window::none) {
    return mean_spectrum(std::span(&image, 1), window, Workers(2));
}

TEST(Fourier, EqualsTheSumForAnySize) {
    std::mt19937 random(1);
    for (const auto& [width, height] :
         {std::pair(1, 1), {2, 1}, {1, 7}, {8, 8}, {7, 5}, {12, 10}, {31, 16}, {61, 67}}) {
        Array2D<double> image(width, height);
        for (double& value : image.values())
            value = double(random()) / double(random.max());
        const auto transformed = fourier(image, Workers(2));
        for (int v = 0; v < height; v += 3)
            for (int u = 0; u < width; ++u) {
                std::complex<double> sum = 0;
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x)
                        sum += image(x, y) * std::polar(1.0, -2 * M_PI *
                                                                 (double(u * x % width) / width +
                                                                  double(v * y % height) / height));
                ASSERT_LT(std::abs(transformed(u, v) - sum), 1e-11 * double(image.size()))
                    << u << ',' << v << " of " << width << 'x' << height;
            }
    }
}

TEST(Fourier, KeepsItsDigitsForLargePrimes) {
    // A plane wave has one entry, whatever the length
    const size_t n = 10007;
    std::vector<std::complex<double>> wave(n);
    for (size_t x = 0; x < n; ++x)
        wave[x] = std::polar(1.0, 2 * M_PI * double(x * 1234 % n) / double(n));
    FourierPlan(n).transform(wave);
    EXPECT_NEAR(std::abs(wave[1234]) / double(n), 1, 1e-13);
    wave[1234] = 0;
    for (const auto& value : wave)
        EXPECT_LT(std::abs(value), 1e-13 * double(n));
}

TEST(Spectrum, PowerSumsToTheVariance) {
    for (const auto& [width, height] : {std::pair(64, 64), {61, 40}, {1, 30}}) {
        const auto image = noise(width, height, 3);
        double mean = 0, variance = 0;
        for (const float value : image.values())
            mean += double(value) / double(image.size());
        for (const float value : image.values())
            variance += std::pow(double(value) - mean, 2) / double(image.size());
        const Spectrum spectrum = spectrum_of(image);
        EXPECT_NEAR(spectrum.mean, mean, 1e-12);
        EXPECT_NEAR(spectrum.variance / variance, 1, 1e-12);
        EXPECT_EQ(spectrum.power[0], 0);
    }
}

TEST(Spectrum, OfWhiteNoiseIsFlat) {
    // Entries of one periodogram are exponential: a mean of n of them is off by 1 / sqrt(n / 2)
    for (const Window window : {Window::none, Window::hann}) {
        const Spectrum spectrum = spectrum_of(noise(512, 512, 4), window);
        EXPECT_NEAR(spectrum.variance, 4, 0.08);
        EXPECT_NEAR(low_frequency_share(spectrum, 0.25), M_PI / 16, 0.004);
        EXPECT_NEAR(low_frequency_share(spectrum, 0.125), M_PI / 64, 0.003);
        EXPECT_NEAR(low_frequency_power(spectrum, 0.25), 1, 0.02);
        for (const double sigma : {1.0, 1.5, 2.0}) {
            const FilteredVariance left = filtered_variance(spectrum, sigma);
            EXPECT_NEAR(left.share * 4 * M_PI * sigma * sigma, 1, 0.05 * sigma);
            EXPECT_NEAR(left.to_white, 1, 0.05 * sigma);
        }
        EXPECT_NEAR(autocorrelation(spectrum, 0, 0), 1, 1e-12);
        EXPECT_NEAR(autocorrelation(spectrum, 1, 0), 0, 0.01);
        if (window == Window::hann) continue; // neighbouring frequencies are no longer independent
        for (const RadialBin& bin : radial_profile(spectrum))
            if (bin.samples > 500) {
                EXPECT_NEAR(bin.power, 1, 6 / std::sqrt(bin.samples / 2.0));
                EXPECT_NEAR(bin.anisotropy, 0, 2.5);
            }
    }
}

TEST(Spectrum, AveragingFramesNarrowsTheAnnuliByTheirNumber) {
    std::vector<Array2D<float>> frames;
    for (unsigned i = 0; i < 10; ++i)
        frames.push_back(noise(128, 128, 100 + i));
    const Spectrum spectrum = mean_spectrum(frames, Window::none, Workers(1));
    EXPECT_EQ(spectrum.frames, 10);
    double sum = 0;
    int count = 0;
    for (const RadialBin& bin : radial_profile(spectrum))
        if (bin.frequency < 0.5 && bin.samples > 100) {
            sum += bin.anisotropy;
            ++count;
        }
    EXPECT_NEAR(sum / count, -10, 0.4);
}

TEST(Spectrum, OfASinusoidHasTwoEntries) {
    Array2D<float> image(60, 48);
    for (int y = 0; y < 48; ++y)
        for (int x = 0; x < 60; ++x)
            image(x, y) = float(5 + std::cos(2 * M_PI * (7.0 * x / 60 + 5.0 * y / 48)));
    const Spectrum spectrum = spectrum_of(image);
    EXPECT_NEAR(spectrum.variance, 0.5, 1e-6);
    EXPECT_NEAR(spectrum.power(7, 5) / double(image.size()), 0.25, 1e-6);
    EXPECT_NEAR(spectrum.power(53, 43) / double(image.size()), 0.25, 1e-6);
    const double f = std::hypot(7.0 / 60, 5.0 / 48);
    EXPECT_NEAR(low_frequency_share(spectrum, f * 0.999), 0, 1e-9);
    EXPECT_NEAR(low_frequency_share(spectrum, f * 1.001), 1, 1e-9);
    EXPECT_NEAR(filtered_variance(spectrum, 1).share, std::exp(-4 * M_PI * M_PI * f * f), 1e-6);
    EXPECT_NEAR(autocorrelation(spectrum, 1, 0), std::cos(2 * M_PI * 7 / 60), 1e-6);
    EXPECT_NEAR(autocorrelation(spectrum, 0, 1), std::cos(2 * M_PI * 5 / 48), 1e-6);
}

TEST(Spectrum, OfAConstantIsNothingAndItsSharesAreNoNumbers) {
    const Spectrum spectrum = spectrum_of(Array2D<float>(33, 20, 0.1f));
    EXPECT_EQ(spectrum.variance, 0);
    EXPECT_FLOAT_EQ(float(spectrum.mean), 0.1f);
    EXPECT_TRUE(std::isnan(low_frequency_share(spectrum, 0.25)));
    EXPECT_TRUE(std::isnan(filtered_variance(spectrum, 1).share));
}

TEST(Spectrum, TheHannWindowKeepsABorderFromLookingLikeNoise) {
    // A ramp jumps where it wraps around: without a window that jump is in all frequencies
    Array2D<float> ramp(128, 128);
    for (int y = 0; y < 128; ++y)
        for (int x = 0; x < 128; ++x)
            ramp(x, y) = float(x);
    const double plain = 1 - low_frequency_share(spectrum_of(ramp), 0.125);
    const double hann = 1 - low_frequency_share(spectrum_of(ramp, Window::hann), 0.125);
    EXPECT_LT(hann, plain / 100);
}

TEST(Spectrum, FilteredVarianceIsThatOfTheFilteredImage) {
    const auto image = noise(96, 64, 8);
    const Spectrum spectrum = spectrum_of(image);
    for (const double sigma : {1.0, 1.7}) {
        const auto blurred = filtered(image, gaussian_taps(sigma), Border::wrap, Workers(1));
        const double direct = spectrum_of(blurred).variance / spectrum.variance;
        EXPECT_NEAR(filtered_variance(spectrum, sigma).share / direct, 1, 0.003);
    }
}

TEST(Spectrum, DoesNotDependOnTheThreadCount) {
    const std::vector<Array2D<float>> frames = {noise(130, 97, 1), noise(130, 97, 2)};
    const Spectrum one = mean_spectrum(frames, Window::hann, Workers(1));
    EXPECT_EQ(one.power, mean_spectrum(frames, Window::hann, Workers(3)).power);
}

Array2D<float> shuffled_ranks(int side, unsigned seed) {
    std::vector<float> values(size_t(side) * size_t(side));
    std::iota(values.begin(), values.end(), 0.0f);
    std::shuffle(values.begin(), values.end(), std::mt19937(seed));
    return {side, side, values};
}

// Straight from the definition: every threshold, every pixel, every pair of taps.
double slow_heaviside_rms(const Array2D<float>& u, const std::vector<double>& taps) {
    double total = 0;
    const int n = u.width(), radius = int(taps.size() / 2);
    for (int i = 0; i < 128; ++i)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) {
                double sum = 0;
                for (int b = 0; b < int(taps.size()); ++b)
                    for (int a = 0; a < int(taps.size()); ++a)
                        sum +=
                            taps[size_t(a)] * taps[size_t(b)] *
                            ((u(wrap(x + a - radius, n), wrap(y + b - radius, n)) < float(i) / 128
                                  ? 1
                                  : 0) -
                             i / 128.0);
                total += sum * sum;
            }
    return std::sqrt(total / (128.0 * n * n));
}

TEST(HeavisideRms, EqualsTheDefinition) {
    const auto ranks = rank_values(shuffled_ranks(12, 1));
    for (const auto& taps : {gaussian_taps(0.7), binomial_taps(3), box_taps(3)})
        EXPECT_NEAR(heaviside_rms(ranks, taps, Workers(2)), slow_heaviside_rms(ranks, taps), 1e-6);
}

TEST(HeavisideRms, OfWhiteNoiseIsThatOfTheory) {
    // Root of the mean of t (1 - t) over the thresholds, times the norm of the taps in 2D
    double spread = 0;
    for (int i = 1; i < 128; ++i)
        spread += i / 128.0 * (1 - i / 128.0) / 128;
    const auto table = heaviside_table(rank_values(shuffled_ranks(128, 2)), Workers(2));
    ASSERT_EQ(table.size(), 6u);
    const std::vector<std::vector<double>> taps = {gaussian_taps(1), gaussian_taps(0.7),
                                                   binomial_taps(2), binomial_taps(3),
                                                   box_taps(3),      box_taps(5)};
    for (size_t i = 0; i < table.size(); ++i) {
        const double norm =
            std::inner_product(taps[i].begin(), taps[i].end(), taps[i].begin(), 0.0);
        EXPECT_NEAR(table[i].rms / (std::sqrt(spread) * norm), 1, 0.06) << table[i].filter;
    }
}

TEST(RankValues, AreTheMiddlesOfTheRanks) {
    const Array2D<float> mask(4, 1, std::vector<float>{7, -1, 7, 100});
    EXPECT_EQ(rank_values(mask).values(), (std::vector<float>{0.5f, 0.125f, 0.5f, 0.875f}));
}

TEST(ValueCounts, CountLevelsAndTheirDistanceFromUniform) {
    Array2D<float> mask(16, 16);
    for (size_t i = 0; i < 256; ++i)
        mask[i] = float(i % 64) / 63.0f;
    const ValueCounts counts = value_counts(mask);
    EXPECT_EQ(counts.distinct, 64u);
    EXPECT_EQ(counts.fewest, 4u);
    EXPECT_EQ(counts.most, 4u);
    EXPECT_LT(counts.uniformity_error, 1.01 / 64);
    for (float& value : mask.values())
        value *= value;
    EXPECT_GT(value_counts(mask).uniformity_error, 0.2);
}

TEST(SeamTest, SeesAStepAtTheSeamAndOnlyThere) {
    const auto tileable = shuffled_ranks(64, 3);
    EXPECT_LT(std::abs(seam_test(tileable).horizontal), 4);
    EXPECT_LT(std::abs(seam_test(tileable).vertical), 4);
    auto ramp = tileable;
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            ramp(x, y) += float(x) * 500;
    EXPECT_GT(seam_test(ramp).horizontal, 20);
    EXPECT_LT(std::abs(seam_test(ramp).vertical), 4);
}

} // namespace
} // namespace ql
