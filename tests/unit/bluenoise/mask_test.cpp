#include "bluenoise/mask.h"

#include "bluenoise/mask_file.h"
#include "bluenoise/void_and_cluster.h"
#include "reference/void_and_cluster_reference.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ql {
namespace {

MaskConfig config(MaskMethod method, int width, int height, uint64_t seed = 0) {
    MaskConfig config;
    config.method = method;
    config.width = width;
    config.height = height;
    config.seed = seed;
    return config;
}

Array2D<uint32_t> ranks(const MaskConfig& mask) {
    Progress progress;
    return mask_ranks(mask, progress);
}

bool each_rank_once(Array2D<uint32_t> mask) {
    std::sort(mask.values().begin(), mask.values().end());
    for (size_t i = 0; i < mask.size(); ++i)
        if (mask[i] != i) return false;
    return true;
}

constexpr std::pair<int, int> kSizes[] = {{1, 1}, {1, 2},   {1, 7},   {13, 1}, {2, 2}, {3, 5},
                                          {8, 8}, {61, 67}, {64, 32}, {9, 64}, {7, 7}, {100, 3}};

TEST(Mask, HoldsEachRankOnceForAnySize) {
    for (const auto& [width, height] : kSizes)
        for (const MaskMethod method : {MaskMethod::void_and_cluster, MaskMethod::white})
            EXPECT_TRUE(each_rank_once(ranks(config(method, width, height))))
                << width << 'x' << height;
}

TEST(Mask, VoidAndClusterEqualsItsSlowTwin) {
    Progress progress;
    for (const auto& [width, height] :
         {std::pair{1, 1}, {1, 2}, {1, 11}, {4, 4}, {5, 3}, {16, 12}, {23, 17}})
        for (const double sigma : {0.3, 1.2, 1.9}) {
            const auto priority = ranks(config(MaskMethod::white, width, height, 5)).values();
            EXPECT_EQ(void_and_cluster(width, height, sigma, priority, progress),
                      reference::void_and_cluster(width, height, sigma, priority))
                << width << 'x' << height << " sigma " << sigma;
        }
}

TEST(Mask, DependsOnSeedAndChannel) {
    const MaskConfig base = config(MaskMethod::void_and_cluster, 16, 16, 1);
    MaskConfig channel = base;
    channel.channel = 1;
    EXPECT_EQ(ranks(base), ranks(base));
    EXPECT_NE(ranks(base), ranks(config(MaskMethod::void_and_cluster, 16, 16, 2)));
    EXPECT_NE(ranks(base), ranks(channel));
}

TEST(Mask, BayerIsTheClassicMatrix) {
    const Array2D<uint32_t> four(4, 4, {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5});
    EXPECT_EQ(ranks(config(MaskMethod::bayer, 4, 4)), four);
}

TEST(Mask, BayerTakesAnyPowersOfTwoAndNothingElse) {
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 8}, {2, 1}, {16, 4}, {4, 32}})
        EXPECT_TRUE(each_rank_once(ranks(config(MaskMethod::bayer, width, height))));
    EXPECT_THROW(ranks(config(MaskMethod::bayer, 6, 8)), Error);
}

// Low ranks of a blue mask keep apart: the nearest pair of the first sixteenth is far above the
// one pixel that white noise leaves.
TEST(Mask, VoidAndClusterKeepsLowRanksApart) {
    const Array2D<uint32_t> mask = ranks(config(MaskMethod::void_and_cluster, 32, 32, 3));
    int nearest = 32 * 32;
    for (int i = 0; i < 1024; ++i)
        for (int j = 0; j < i; ++j) {
            if (mask[size_t(i)] >= 64 || mask[size_t(j)] >= 64) continue;
            const int dx = std::abs(i % 32 - j % 32), dy = std::abs(i / 32 - j / 32);
            const int ax = std::min(dx, 32 - dx), ay = std::min(dy, 32 - dy);
            nearest = std::min(nearest, ax * ax + ay * ay);
        }
    EXPECT_GE(nearest, 8);
}

TEST(Mask, RefusesSizesAndSigmasOutOfRange) {
    EXPECT_THROW(check_mask_config(config(MaskMethod::white, 8192, 4096)), Error);
    EXPECT_THROW(check_mask_config(config(MaskMethod::white, 0, 4)), Error);
    MaskConfig flat = config(MaskMethod::void_and_cluster, 4, 4);
    flat.sigma_px = 0.1;
    EXPECT_THROW(check_mask_config(flat), Error);
    flat.sigma_px = std::nan("");
    EXPECT_THROW(check_mask_config(flat), Error);
}

TEST(MaskFile, RanksComeBackExactlyFromFloatAndFrom16Bits) {
    for (const auto& [width, height] :
         {std::pair{61, 67}, {1, 1}, {200, 200}, {255, 257}, {256, 256}}) {
        const MaskConfig mask = config(MaskMethod::white, width, height);
        const Array2D<uint32_t> expected = ranks(mask);
        EXPECT_EQ(mask_from_image(mask_image({expected}, mask, MaskSamples::exact), "", "m").values,
                  expected);
        Image png = mask_image({expected}, mask, MaskSamples::bits16);
        png.source_bits = 16;
        Array2D<uint32_t> samples = mask_from_image(png, "", "m").values;
        for (uint32_t& sample : samples.values())
            sample = uint32_t((2 * uint64_t(sample) + 1) * expected.size() / 131072);
        EXPECT_EQ(samples, expected);
    }
}

TEST(MaskFile, FloatMasksKeepTies) {
    Image image(2, 2);
    image.plane("Y").values() = {0.5f, -1.0f, 7.0f, 0.5f};
    const Mask mask = mask_from_image(image, "", "m");
    EXPECT_EQ(mask.values, Array2D<uint32_t>(2, 2, {1, 0, 2, 1}));
    EXPECT_EQ(mask.levels, 3u);
}

TEST(MaskFile, SeveralChannelsNeedAChoice) {
    Image image(2, 1);
    image.plane("R").values() = {0.0f, 1.0f};
    image.plane("G").values() = {1.0f, 0.0f};
    image.plane("B").values() = {0.0f, 1.0f};
    EXPECT_THROW(mask_from_image(image, "", "m"), Error);
    EXPECT_THROW(mask_from_image(image, "Z", "m"), Error);
    EXPECT_EQ(mask_from_image(image, "G", "m").values, Array2D<uint32_t>(2, 1, {1, 0}));
    image.plane("G") = image.plane("B");
    EXPECT_EQ(mask_from_image(image, "", "m").values, Array2D<uint32_t>(2, 1, {0, 1}));
}

} // namespace
} // namespace ql
