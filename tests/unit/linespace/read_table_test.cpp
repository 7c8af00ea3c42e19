#include "linespace/measure.h"
#include "linespace/read_table.h"
#include "reference/linespace_scenes.h"
#include "render/posed_scene.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

// A voxel's shafts, measured, some of them with light; measures of groups are exact sums.
struct SparseCache {
    LightCache cache;
    std::vector<double> measures; // of all shafts

    SparseCache(const PosedScene& posed, const Workers& workers) {
        const VoxelGrid grid = grid_over(posed.world(), {{1, 1, 1}, 0});
        LightCache all;
        all.header.patches = 2;
        all.header.normal_classes = 1;
        all.header.voxels = grid.counts;
        all.header.lower = posed.world().space.to_world(grid.lower);
        all.header.cell = grid.cell / posed.world().space.scale;
        all.header.unit = 1;
        all.header.photons = {{0, 100}};
        all.header.weight_by_order = {1, 3};
        all.header.caustic_by_order = {0, 5};
        for (uint32_t s = 0; s < all.header.directed(); ++s)
            all.shafts.push_back(s);
        all.first = {0, all.shafts.size()};
        all.counts.assign(all.size(), 1);
        all.sums.assign(all.size(), {1, 1, 1});
        Progress progress;
        const OpenSides sides(posed.rays(), LightEmission(posed.lights()), workers);
        measure_shafts(posed.world(), sides, nullptr, {}, {}, all, workers, progress);
        measures.assign(all.measures.begin(), all.measures.end());

        cache.header = all.header;
        CounterRandom random(3);
        for (uint32_t s = 0; s < all.header.directed(); ++s) {
            if (bounded(random, 4) != 0) continue;
            cache.shafts.push_back(s);
            cache.counts.push_back(1 + bounded(random, 5));
            const auto sum = int64_t(bounded(random, 1 << 24));
            cache.sums.push_back({sum, 2 * sum, 3 * sum});
            cache.measures.push_back(all.measures[s]);
        }
        cache.first = {0, cache.size()};
        const ShaftGroups groups(2, 1);
        std::vector<double> group_measures(groups.size());
        for (uint32_t s = 0; s < all.header.directed(); ++s) {
            const uint32_t group = groups.of_shaft(s);
            group_measures[group] += measures[s];
            group_measures[*groups.of_group(group)] += measures[s];
        }
        cache.groups = groups.holding(cache.shafts);
        cache.group_first = {0, cache.groups.size()};
        for (const uint32_t group : cache.groups)
            cache.group_measures.push_back(float(group_measures[group]));
    }
};

class SmoothedTable : public testing::Test {
  protected:
    const Workers workers{2};
    const Scene scene = reference::box_scene({.has_plate = true, .lights = {{{0.5, 0.5, 0.5}, 1}}});
    const PosedScene posed{scene, render_space_of(scene, workers), 0, workers};
    const SparseCache sparse{posed, workers};

    ReadTable table(double smoothing) const {
        return ReadTable(sparse.cache, posed.world().space, posed.lights(), {smoothing}, workers);
    }
};

TEST_F(SmoothedTable, KeepsTheLightOfAVoxel) {
    const auto light = [&](double smoothing) {
        const ReadTable smoothed = table(smoothing);
        double sum = 0;
        for (uint32_t s = 0; s < sparse.measures.size(); ++s)
            sum += double(smoothed.radiance(0, s).y) * sparse.measures[s];
        return sum;
    };
    const double expected = light(0);
    EXPECT_GT(expected, 0);
    for (const double smoothing : {0.01, 1.0, 30.0, 1e9})
        EXPECT_NEAR(light(smoothing) / expected, 1, 1e-5) << smoothing;
}

TEST_F(SmoothedTable, GoesFromTheShaftItselfToTheMeanOfTheVoxel) {
    const ReadTable own = table(0), little = table(1e-9), much = table(1e9);
    const V3f mean = much.radiance(0, 0);
    EXPECT_GT(mean.x, 0);
    for (uint32_t s = 0; s < sparse.measures.size(); ++s) {
        EXPECT_NEAR(little.radiance(0, s).x, own.radiance(0, s).x,
                    1e-5f * own.radiance(0, s).x + 1e-6f);
        EXPECT_NEAR(much.radiance(0, s).x / mean.x, 1, 1e-3);
    }
}

TEST_F(SmoothedTable, SharesOfShortPathsAreThoseOfTheirLayer) {
    const ReadTable own = table(0);
    EXPECT_EQ(own.share_up_to(0), 0);
    EXPECT_EQ(own.share_up_to(1), 0.25f);
    EXPECT_EQ(own.share_up_to(2), 1);
    EXPECT_EQ(own.caustic_share_up_to(1), 0);
    EXPECT_EQ(own.caustic_share_up_to(5), 1);
}

} // namespace
} // namespace ql
