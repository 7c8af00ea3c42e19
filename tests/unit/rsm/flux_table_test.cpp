#include "rsm/flux_table.h"

#include "metrics/statistics.h"
#include "sampling/random.h"
#include "statistics/rsm_scenes.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

using namespace rsm_test;

// Two maps of 3 x 3 texels, some dark, one row dark, all fluxes in green.
std::vector<ReflectiveShadowMap> two_maps() {
    const Stage stage(spot_room(), 4, {0.9, 0.8, 0.9}, {0, 0, 0});
    std::vector<ReflectiveShadowMap> maps = stage.maps({.size = 3});
    maps.push_back(maps[0]);
    const float flux[18] = {0, 1, 5, 0, 0, 0, 2, 2, 0, 7, 1e-3f, 0, 0, 0, 4, 1, 1, 0};
    for (size_t i = 0; i < 18; ++i) {
        Texels& t = maps[i / 9].texels;
        t.red[i % 9] = t.blue[i % 9] = 0;
        t.green[i % 9] = flux[i];
    }
    return maps;
}

TEST(RsmFluxTable, TexelsAreChosenByFlux) {
    const auto maps = two_maps();
    const FluxTable table(maps);
    constexpr uint32_t kDraws = 200000;
    std::vector<uint64_t> counts(18);
    std::vector<double> expected(18);
    for (uint32_t i = 0; i < kDraws; ++i) {
        const RandomFloats u = CounterRandom(1, i).block(0);
        const auto choice = table.sample(double(u[0]), u[1]);
        ++counts[choice.map * 9 + size_t(maps[choice.map].texel_at(choice.uv.x, choice.uv.y))];
    }
    double sum = 0, all = 0;
    for (const ReflectiveShadowMap& map : maps)
        for (size_t i = 0; i < 9; ++i)
            all += double(map.texels.green[i]);
    for (uint32_t i = 0; i < 18; ++i) {
        const V2f middle((float(i % 3) + 0.5f) / 3, (float(i % 9 / 3) + 0.5f) / 3);
        const double p = double(table.density(i / 9, middle)) / 9;
        EXPECT_NEAR(p, double(maps[i / 9].texels.green[i % 9]) / all, 1e-6);
        expected[i] = p * kDraws;
        sum += p;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_GT(chi_square_test(counts, expected).p_value, 1e-3);
}

TEST(RsmFluxTable, CellsOfLargeMapsAreChosenByFluxAndEvenlyInside) {
    // 288 texels make 96 cells of 3, and 286 make 95 and a third.
    for (const int size : {286, 288}) {
        std::vector<ReflectiveShadowMap> maps = two_maps();
        maps.pop_back();
        maps[0].size = size;
        maps[0].texels = Texels(size_t(size) * size_t(size));
        // Flux in a corner of each of two far cells; one is the last of its row.
        maps[0].texels.red[size_t(7 * size + 100)] = 1;
        maps[0].texels.red[size_t(100 * size + size - 1)] = 3;
        const FluxTable table(maps);
        int last = 0, columns[3] = {};
        for (uint32_t i = 0; i < 20000; ++i) {
            const RandomFloats u = CounterRandom(1, i).block(0);
            const auto choice = table.sample(double(u[0]), u[1]);
            const auto texel = maps[0].texel_at(choice.uv.x, choice.uv.y);
            const int x = int(texel % size), y = int(texel / size);
            ASSERT_GT(table.density(0, choice.uv), 0);
            last += y > 50 ? 1 : 0;
            ASSERT_EQ(y / 3, y > 50 ? 33 : 2);
            ASSERT_EQ(x / 3, y > 50 ? (size - 1) / 3 : 33);
            if (y < 50) ++columns[x % 3];
        }
        EXPECT_NEAR(last / 20000.0, 0.75, 0.01);
        for (const int count : columns)
            EXPECT_NEAR(count / 5000.0, 1.0 / 3, 0.03);
        // Share over area: 3/4 in a cell that is one third as wide if the side does not divide.
        const double width = (size == 286 ? 1.0 : 3.0) / size;
        EXPECT_NEAR(double(table.density(0, {1, 100.5f / float(size)})) * width * 3 / size, 0.75,
                    1e-4);
    }
}

TEST(RsmFluxTable, TheEndsOfTheUnitIntervalFallOnLitTexels) {
    const auto maps = two_maps();
    const FluxTable table(maps);
    for (const double row : {0.0, 0.25, 0.5, 1 - 0x1p-53})
        for (const float texel : {0.0f, 1.0f / 3, 2.0f / 3, 0x1.fffffep-1f}) {
            const auto choice = table.sample(row, texel);
            EXPECT_GT(table.density(choice.map, choice.uv), 0);
        }
}

TEST(RsmFluxTable, MapsWithoutFluxGiveAnEmptyTable) {
    auto maps = two_maps();
    for (ReflectiveShadowMap& map : maps)
        map.texels = Texels(9);
    EXPECT_TRUE(FluxTable(maps).empty());
    EXPECT_TRUE(FluxTable(std::span<const ReflectiveShadowMap>()).empty());
}

} // namespace
} // namespace ql
