#include "metrics/filter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>

namespace ql {
namespace {

TEST(Taps, SumToOneAndAreSymmetric) {
    for (const auto& taps : {gaussian_taps(0.3), gaussian_taps(1), gaussian_taps(7.5), box_taps(5),
                             binomial_taps(2), binomial_taps(3)}) {
        EXPECT_NEAR(std::accumulate(taps.begin(), taps.end(), 0.0), 1, 1e-14);
        for (size_t i = 0; i < taps.size(); ++i)
            EXPECT_DOUBLE_EQ(taps[i], taps[taps.size() - 1 - i]);
    }
    EXPECT_EQ(binomial_taps(3), (std::vector{0.125, 0.375, 0.375, 0.125}));
    EXPECT_EQ(gaussian_taps(0), std::vector{1.0});
    EXPECT_EQ(gaussian_taps(1).size(), 9u);
    EXPECT_NEAR(gaussian_taps(1)[5] / gaussian_taps(1)[4], std::exp(-0.5), 1e-14);
}

int beyond(int i, int n, Border border) {
    if (border == Border::wrap) return ((i % n) + n) % n;
    while (i < 0 || i >= n)
        i = i < 0 ? -1 - i : 2 * n - 1 - i;
    return i;
}

TEST(Filtered, EqualsTheTwoDimensionalSum) {
    std::mt19937 random(1);
    for (const Border border : {Border::mirror, Border::wrap})
        for (const auto& [width, height] : {std::pair(9, 5), {2, 3}, {1, 1}, {17, 1}})
            for (const auto& taps : {gaussian_taps(1.3), binomial_taps(3), box_taps(5)}) {
                Array2D<float> image(width, height);
                for (float& value : image.values())
                    value = float(random() % 1000) / 1000.0f;
                const auto result = filtered(image, taps, border, Workers(1));
                const int radius = int(taps.size() / 2);
                for (int y = 0; y < height; ++y)
                    for (int x = 0; x < width; ++x) {
                        double sum = 0;
                        for (int j = 0; j < int(taps.size()); ++j)
                            for (int i = 0; i < int(taps.size()); ++i)
                                sum += taps[size_t(i)] * taps[size_t(j)] *
                                       double(image(beyond(x + i - radius, width, border),
                                                    beyond(y + j - radius, height, border)));
                        ASSERT_NEAR(result(x, y), sum, 1e-6)
                            << x << ',' << y << " of " << width << 'x' << height;
                    }
            }
}

} // namespace
} // namespace ql
