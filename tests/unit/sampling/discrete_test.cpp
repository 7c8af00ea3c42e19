#include "sampling/discrete.h"

#include "sampling/random.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace ql {
namespace {

// Exact probabilities: each slot is a step function of u, so a fine grid of u measures them.
std::vector<double> measured(const AliasTable& table, size_t per_slot) {
    std::vector<double> share(table.size());
    const size_t n = table.size() * per_slot;
    for (size_t i = 0; i < n; ++i) {
        const DiscreteSample s =
            table.sample((static_cast<double>(i) + 0.5) / static_cast<double>(n));
        EXPECT_LT(s.u, 1.0f);
        EXPECT_GE(s.u, 0.0f);
        share[s.index] += 1.0 / static_cast<double>(n);
    }
    return share;
}

TEST(AliasTable, DrawsInProportionToTheWeights) {
    const std::array<double, 6> weights = {3, 0, 1, 10, 0.5, 2};
    const AliasTable table(weights);
    EXPECT_DOUBLE_EQ(table.sum(), 16.5);
    const std::vector<double> share = measured(table, 100000);
    for (size_t i = 0; i < weights.size(); ++i) {
        EXPECT_NEAR(share[i], weights[i] / 16.5, 2e-5);
        EXPECT_NEAR(table.probability(i), weights[i] / 16.5, 1e-7);
    }
    EXPECT_EQ(share[1], 0);
}

TEST(AliasTable, IsEmptyWhereNothingCanBeDrawn) {
    EXPECT_TRUE(AliasTable().empty());
    EXPECT_TRUE(AliasTable(std::vector<double>{}).empty());
    EXPECT_TRUE(AliasTable(std::vector<double>{0, 0, 0}).empty());
    EXPECT_TRUE(AliasTable(std::vector<double>{-1, std::nan("")}).empty());
    EXPECT_EQ(AliasTable(std::vector<double>{0, 0}).probability(1), 0);
}

TEST(AliasTable, NeverDrawsWeightsThatAreNotPositiveAndFinite) {
    const AliasTable table(
        std::vector<double>{0, -5, std::numeric_limits<double>::infinity(), std::nan(""), 2, 1});
    const std::vector<double> share = measured(table, 3000);
    EXPECT_NEAR(share[4], 2.0 / 3, 1e-3);
    EXPECT_NEAR(share[5], 1.0 / 3, 1e-3);
    EXPECT_NEAR(share[4] + share[5], 1, 1e-12);
}

TEST(AliasTable, StandsAHugeDynamicRange) {
    for (const double scale : {1e-300, 1e-30, 1.0, 1e30, 1e300}) {
        const AliasTable table(std::vector<double>{scale, 1e-30 * scale, 0, scale});
        const std::vector<double> share = measured(table, 1000);
        EXPECT_NEAR(share[0], 0.5, 2e-3) << scale;
        EXPECT_NEAR(share[3], 0.5, 2e-3) << scale;
        EXPECT_EQ(share[2], 0) << scale;
    }
    const AliasTable table(std::vector<double>{1e-30, 1e30});
    EXPECT_EQ(table.sample(0.0).index, 1u);
    EXPECT_EQ(table.sample(0.999).index, 1u);
}

TEST(AliasTable, LeavesAUniformNumber) {
    const AliasTable table(std::vector<double>{1, 5, 2});
    constexpr int kDraws = 90000;
    std::array<std::array<int, 10>, 3> counts{};
    for (int i = 0; i < kDraws; ++i) {
        const DiscreteSample s = table.sample((i + 0.5) / kDraws);
        ++counts[s.index][static_cast<size_t>(s.u * 10)];
    }
    for (size_t i = 0; i < 3; ++i)
        for (const int count : counts[i])
            EXPECT_NEAR(count, kDraws * table.probability(i) / 10, 5);
}

TEST(AliasTable, TakesOneItemAndAMillion) {
    const AliasTable one(std::vector<double>{3});
    EXPECT_EQ(one.sample(0.7).index, 0u);
    EXPECT_EQ(one.sample(0.7).probability, 1);
    EXPECT_NEAR(one.sample(0.7).u, 0.7, 1e-6);

    std::vector<double> weights(1000000);
    for (size_t i = 0; i < weights.size(); ++i)
        weights[i] = static_cast<double>(i % 7);
    const AliasTable table(weights);
    std::array<double, 7> by_weight{};
    for (uint64_t i = 0; i < 200000; ++i) {
        const RandomWords w = CounterRandom(5, i).words(0);
        by_weight[table.sample(unit_double(w[0], w[1])).index % 7] += 1.0 / 200000;
    }
    for (size_t i = 0; i < 7; ++i)
        EXPECT_NEAR(by_weight[i], static_cast<double>(i) / 21, 0.005);
}

} // namespace
} // namespace ql
