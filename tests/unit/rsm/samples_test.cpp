#include "rsm/samples.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ql {
namespace {

TEST(rsm_samples, the_pattern_has_one_point_in_each_ring) {
    const PassSamples samples = pattern_samples(100, 1, 2);
    ASSERT_EQ(samples.pattern.size(), 100u);
    std::vector<int> rings;
    for (size_t i = 0; i < 100; ++i) {
        rings.push_back(int(samples.pattern.xi1[i] * 100));
        EXPECT_GE(samples.pattern.xi2[i], 0);
        EXPECT_LT(samples.pattern.xi2[i], 1);
        EXPECT_NEAR(std::hypot(samples.pattern.x[i], samples.pattern.y[i]), samples.pattern.xi1[i],
                    1e-6);
    }
    std::sort(rings.begin(), rings.end());
    for (int i = 0; i < 100; ++i)
        EXPECT_EQ(rings[size_t(i)], i);
}

TEST(rsm_samples, passes_and_seeds_have_sets_of_their_own) {
    EXPECT_TRUE(pattern_samples(5, 1, 2).pattern == pattern_samples(5, 1, 2).pattern);
    EXPECT_FALSE(pattern_samples(5, 1, 2).pattern == pattern_samples(5, 1, 3).pattern);
    EXPECT_FALSE(pattern_samples(5, 1, 2).pattern == pattern_samples(5, 2, 2).pattern);
}

TEST(rsm_samples, importance_splits_its_samples_in_two) {
    for (const int n : {1, 2, 7}) {
        const PassSamples samples = importance_samples(n, 0, 0);
        EXPECT_EQ(int(samples.flux.size() + samples.around.size()), n);
        EXPECT_GE(samples.flux.size(), samples.around.size());
    }
}

TEST(rsm_samples, shifts_stay_below_one) {
    EXPECT_LT(shifted(0x1.fffffep-1f, 0x1.fffffep-1f), 1);
    EXPECT_LT(shifted(1 - 0x1p-53, 0x1.fffffep-1f), 1);
    EXPECT_EQ(shifted(0.75f, 0.5f), 0.25f);
    const Array2D<float> mask(2, 2, 0x1.fffffep-1f);
    const ShiftSource blue{Rotation::blue, &mask, 0};
    for (uint32_t pass = 0; pass < 1000; ++pass)
        for (const float s : blue.shift(3, 5, pass)) {
            EXPECT_GE(s, 0);
            EXPECT_LT(s, 1);
        }
}

TEST(rsm_samples, no_rotation_is_no_shift) {
    EXPECT_EQ((ShiftSource{}.shift(3, 4, 5)), (std::array<float, 3>{0, 0, 0}));
}

TEST(rsm_samples, a_mask_repeats_and_white_noise_does_not) {
    Array2D<float> mask(4, 3);
    for (size_t i = 0; i < mask.size(); ++i)
        mask[i] = float(i) / 12;
    const ShiftSource blue{Rotation::blue, &mask, 0}, white{Rotation::white, nullptr, 0};
    EXPECT_EQ(blue.shift(1, 2, 0), blue.shift(5, 5, 0));
    EXPECT_NE(blue.shift(1, 2, 0), blue.shift(2, 2, 0));
    EXPECT_NE(white.shift(1, 2, 0), white.shift(5, 5, 0));
}

} // namespace
} // namespace ql
