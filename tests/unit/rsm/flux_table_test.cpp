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

TEST(rsm_flux_table, texels_are_chosen_by_flux) {
    const auto maps = two_maps();
    const FluxTable table(maps);
    constexpr uint32_t kDraws = 200000;
    std::vector<uint64_t> counts(18);
    std::vector<double> expected(18);
    for (uint32_t i = 0; i < kDraws; ++i) {
        const RandomFloats u = CounterRandom(1, i).block(0);
        const auto choice = table.sample(double(u[0]), u[1]);
        ASSERT_EQ(maps[choice.map].texel_at(choice.uv.x, choice.uv.y), int64_t(choice.texel));
        ++counts[choice.map * 9 + choice.texel];
    }
    double sum = 0;
    for (size_t i = 0; i < 18; ++i) {
        const float p = table.probability(maps[i / 9].texels.flux(i % 9));
        expected[i] = double(p) * kDraws;
        sum += double(p);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    EXPECT_GT(chi_square_test(counts, expected).p_value, 1e-3);
}

TEST(rsm_flux_table, the_ends_of_the_unit_interval_fall_on_lit_texels) {
    const auto maps = two_maps();
    const FluxTable table(maps);
    for (const double row : {0.0, 0.25, 0.5, 1 - 0x1p-53})
        for (const float texel : {0.0f, 1.0f / 3, 2.0f / 3, 0x1.fffffep-1f}) {
            const auto choice = table.sample(row, texel);
            EXPECT_GT(maps[choice.map].texels.green[choice.texel], 0);
        }
}

TEST(rsm_flux_table, maps_without_flux_give_an_empty_table) {
    auto maps = two_maps();
    for (ReflectiveShadowMap& map : maps)
        map.texels = Texels(9);
    EXPECT_TRUE(FluxTable(maps).empty());
    EXPECT_TRUE(FluxTable(std::span<const ReflectiveShadowMap>()).empty());
}

} // namespace
} // namespace ql
