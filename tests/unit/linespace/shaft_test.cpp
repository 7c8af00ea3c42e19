#include "linespace/etendue.h"
#include "linespace/shaft.h"
#include "reference/shaft_reference.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

namespace ql {
namespace {

V3d random_point(CounterRandom& random) {
    return {double(random.next_float()), double(random.next_float()), double(random.next_float())};
}

V3d random_direction(CounterRandom& random) {
    return (random_point(random) * 2.0 - V3d(1)).normalized();
}

TEST(Shafts, NumbersAndEndsAreInverseForAllShafts) {
    for (int n = 1; n <= 8; ++n) {
        std::vector<char> seen(directed_shaft_count(n), 0);
        for (int a = 0; a < 6; ++a)
            for (int b = 0; b < 6; ++b) {
                if (a == b) continue;
                for (int p = 0; p < n * n; ++p)
                    for (int q = 0; q < n * n; ++q) {
                        const ShaftEnds ends{a, p, b, q};
                        const uint32_t number = directed_shaft(ends, n);
                        ASSERT_LT(number, seen.size());
                        ASSERT_FALSE(seen[number]);
                        seen[number] = 1;
                        ASSERT_EQ(shaft_ends(number, n), ends);
                        // The opposite direction is the same shaft.
                        ASSERT_EQ(directed_shaft({b, q, a, p}, n), number ^ 1u);
                    }
            }
    }
}

TEST(Shafts, LocateAgreesWithTheBruteForceTwinOnRandomLines) {
    const VoxelGrid grid{{-0.3, 0.2, -1}, {0.11, 0.07, 0.5}, {5, 7, 3}};
    CounterRandom random(7);
    for (int n = 1; n <= 8; ++n)
        for (int i = 0; i < 20000; ++i) {
            const V3d size = grid.upper() - grid.lower;
            const V3d u = random_point(random);
            const V3d point = grid.lower + V3d(u.x * size.x, u.y * size.y, u.z * size.z);
            const V3d direction = random_direction(random);
            const auto place = locate(grid, n, point, direction);
            const auto twin = reference::locate(grid, n, point, direction);
            ASSERT_EQ(place.has_value(), twin.has_value());
            ASSERT_TRUE(place);
            EXPECT_EQ(place->voxel, twin->voxel);
            EXPECT_EQ(place->shaft, twin->shaft);
            EXPECT_NEAR(place->t_entry, twin->t_entry, 1e-12);
            // Every other point of the line in the voxel gives the same shaft, the opposite
            // direction its partner.
            const V3d further = point + direction * (0.5 * place->t_entry);
            EXPECT_EQ(locate(grid, n, further, direction)->shaft, place->shaft);
            EXPECT_EQ(locate(grid, n, point, -direction)->shaft, place->shaft ^ 1u);
        }
}

TEST(Shafts, RandomLinesReachEveryDirectedShaft) {
    const VoxelGrid grid{{0, 0, 0}, {1, 1, 1}, {1, 1, 1}};
    for (int n = 1; n <= 2; ++n) {
        std::set<uint32_t> found;
        CounterRandom random{uint64_t(n)};
        for (int i = 0; i < 400000; ++i) {
            const V3d point = random_point(random);
            found.insert(locate(grid, n, point, random_direction(random))->shaft);
        }
        EXPECT_EQ(found.size(), directed_shaft_count(n));
    }
}

TEST(Shafts, PointsOutsideOfTheGridHaveNone) {
    const VoxelGrid grid{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    EXPECT_FALSE(locate(grid, 4, {-1e-9, 1, 1}, {1, 0, 0}));
    EXPECT_FALSE(locate(grid, 4, {1, 2, 1}, {1, 0, 0}));
    EXPECT_FALSE(locate(grid, 4, {1, std::nan(""), 1}, {1, 0, 0}));
    EXPECT_TRUE(locate(grid, 4, {0, 0, 0}, {1, 0, 0}));
}

TEST(Shafts, TheSameLineAtAnyScaleIsTheSameShaft) {
    CounterRandom random(3);
    for (const double s : {1e-6, 1e-3, 1.0, 1e3, 1e6})
        for (int i = 0; i < 1000; ++i) {
            const V3d p = random_point(random), d = random_direction(random);
            const VoxelGrid unit{{0, 0, 0}, {0.25, 0.25, 0.25}, {4, 4, 4}};
            const VoxelGrid scaled{{0, 0, 0}, V3d(0.25 * s), {4, 4, 4}};
            EXPECT_EQ(locate(unit, 4, p, d)->shaft, locate(scaled, 4, p * s, d)->shaft);
        }
}

TEST(Etendue, OfAnEntryPatchSumsToPiTimesItsArea) {
    const V3d voxels[] = {{1, 1, 1},         {0.3, 1, 2},     {1, 1, 0.001},
                          {0.001, 0.001, 1}, {1e-3, 1, 0.03}, {1e-6, 1e-6, 1e-9}};
    for (const V3d& voxel : voxels)
        for (const int n : {1, 2, 3, 4, 7, 8}) {
            const EtendueTable table(voxel, n);
            for (int face = 0; face < 6; ++face)
                for (int patch = 0; patch < n * n; ++patch) {
                    double sum = 0;
                    for (int other = 0; other < 6; ++other)
                        for (int q = 0; other != face && q < n * n; ++q) {
                            const double g = table({face, patch, other, q});
                            ASSERT_GT(g, 0);
                            sum += g;
                        }
                    const double area =
                        voxel[detail::kAxisU[face / 2]] * voxel[detail::kAxisV[face / 2]] / (n * n);
                    ASSERT_NEAR(sum / (std::numbers::pi * area), 1, 1e-6)
                        << voxel << " N " << n << " face " << face << " patch " << patch;
                }
        }
}

TEST(Etendue, OfSingleShaftsAgreesWithNumericalIntegration) {
    for (const V3d& voxel : {V3d(1, 1, 1), V3d(0.7, 1, 1.4)}) {
        const EtendueTable table(voxel, 3);
        CounterRandom random(11);
        for (int i = 0; i < 80; ++i) {
            const uint32_t shaft = bounded(random, directed_shaft_count(3));
            // The rule of points converges too slowly where patches touch; the sums cover those.
            if (reference::patches_touch(3, shaft_ends(shaft, 3))) continue;
            const double expected = reference::etendue(voxel, 3, shaft_ends(shaft, 3));
            EXPECT_NEAR(table(shaft) / expected, 1, 2e-3) << shaft;
        }
    }
}

} // namespace
} // namespace ql
