#include "linespace/candidates.h"
#include "linespace/etendue.h"
#include "linespace/measure.h"
#include "reference/linespace_scenes.h"
#include "reference/scene_builder.h"
#include "render/posed_scene.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ql {
namespace {

// A cache with every gated shaft of every voxel.
LightCache full_cache(const VoxelGrid& grid, const RenderSpace& space, int patches) {
    LightCache cache;
    cache.header.patches = patches;
    cache.header.normal_classes = 1;
    cache.header.voxels = grid.counts;
    cache.header.lower = space.to_world(grid.lower);
    cache.header.cell = grid.cell / space.scale;
    const uint32_t directed = directed_shaft_count(patches);
    cache.first.push_back(0);
    for (uint64_t v = 0; v < grid.size(); ++v) {
        for (uint32_t s = 0; s < directed; ++s)
            cache.shafts.push_back(s);
        cache.first.push_back(cache.shafts.size());
    }
    cache.counts.assign(cache.size(), 1);
    cache.sums.assign(cache.size(), {1, 1, 1});
    return cache;
}

constexpr int kLines = 512;

// Undoes (n + a)/(K + a) with a = (1 + n/2)/(1 + n), see measure.cpp, by bisection.
double without_added_hits(double share) {
    double low = 0, high = kLines;
    for (int i = 0; i < 50; ++i) {
        const double n = (low + high) / 2, a = (1 + 0.5 * n) / (1 + n);
        ((n + a) / (kLines + a) < share ? low : high) = n;
    }
    return low / kLines;
}

// Measures with a fixed number of lines; takes back what is added for the sake of the inverse.
std::vector<double> measures_of(const PosedScene& scene, LightCache& cache, double blur = 0) {
    const Workers workers(2);
    Progress progress;
    const OpenSides sides(scene.rays(), LightEmission(scene.lights()), workers);
    measure_shafts(scene.world(), sides, nullptr, Blur(scene.rays(), &sides, blur),
                   {kLines, 1000000}, cache, workers, progress);
    const EtendueTable etendue(cache.header.cell, cache.header.patches);
    std::vector<double> measures(cache.size());
    for (size_t i = 0; i < cache.size(); ++i) {
        const double g = etendue(cache.shafts[i]);
        const double share = double(cache.measures[i]) / g;
        // Shafts whose first 32 lines all hit stop there, with a share of 1.
        measures[i] = share > 0.9999 ? g : g * without_added_hits(share);
    }
    return measures;
}

TEST(Measure, OfAllShaftsSumsToPiTimesBothSidesOfASurface) {
    const Scene scene = reference::tilted_square();
    const Workers workers(2);
    const PosedScene posed(scene, render_space_of(scene, workers), 0, workers);
    for (const auto& [voxels, patches] : {std::pair(1, 4), std::pair(3, 2), std::pair(2, 3)}) {
        const VoxelGrid grid = grid_over(posed.world(), {{voxels, voxels, voxels}, 0});
        LightCache cache = full_cache(grid, posed.world().space, patches);
        double sum = 0;
        for (const double m : measures_of(posed, cache))
            sum += m;
        EXPECT_NEAR(sum / (2 * std::numbers::pi), 1, 0.01) << voxels << " " << patches;
    }
}

// A blur moves points neither over a rim nor behind a fold: as many come as go.
TEST(Measure, OfAllShaftsIsTheSameWithABlurThatCrossesAFold) {
    reference::SceneBuilder b;
    const int material = b.add_material(reference::lambert(V3f(0.5f)));
    b.add_quad({0, 0, 0}, {1, 0, 0.01f}, {0, 2, 0}, material);
    b.add_quad({1, 0, 0.01f}, {1, 0, -0.01f}, {0, 2, 0}, material);
    const Workers workers(2);
    const PosedScene posed(b.scene, render_space_of(b.scene, workers), 0, workers);
    const double scale = posed.world().space.scale;
    const VoxelGrid grid = grid_over(posed.world(), {{3, 3, 1}, 0});
    LightCache cache = full_cache(grid, posed.world().space, 2);
    double sum = 0;
    for (const double m : measures_of(posed, cache, 0.3 * scale))
        sum += m;
    EXPECT_NEAR(sum / (2 * std::numbers::pi * 4), 1, 0.01);
}

// Points on the surfaces with cosine directions, counted by shaft.
std::vector<double> area_measures(const PosedScene& posed, const VoxelGrid& grid, int patches,
                                  int samples_per_triangle) {
    const World& world = posed.world();
    std::vector<double> sums(grid.size() * directed_shaft_count(patches), 0);
    CounterRandom random(1);
    for (uint32_t s = 0; s < world.surfaces.size(); ++s)
        for (uint32_t t = 0; t < 2; ++t) {
            const auto corners = triangle_corners(world, s, t);
            const V3f e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
            const double area = double(e1.cross(e2).length()) / 2;
            const V3f normal = e1.cross(e2).normalized();
            for (int i = 0; i < samples_per_triangle; ++i) {
                const RandomFloats u = random.next_block();
                const V2f b = square_to_uniform_triangle({u[0], u[1]});
                const V3f n = i % 2 ? normal : -normal;
                const V3f w = frame_from_normal(n).world_from_local(
                    square_to_cosine_hemisphere({u[2], u[3]}));
                const V3f start = offset_origin(corners[0] + e1 * b.x + e2 * b.y, n, 1e-6f, w);
                const auto place = locate(grid, patches, V3d(start), V3d(w));
                if (!place) continue;
                if (posed.rays().is_occluded({start, 0, w, float(place->t_entry)}, 0)) continue;
                sums[size_t(place->voxel) * directed_shaft_count(patches) + place->shaft] +=
                    2 * std::numbers::pi * area / samples_per_triangle;
            }
        }
    return sums;
}

TEST(Measure, AgreesWithPointsOnTheSurfacesWhereAPlateHidesTheFloor) {
    const Scene scene = reference::box_scene({.has_plate = true});
    const Workers workers(2);
    const PosedScene posed(scene, render_space_of(scene, workers), 0, workers);
    const int patches = 2;
    const VoxelGrid grid = grid_over(posed.world(), {{2, 2, 2}, 0});
    LightCache cache = full_cache(grid, posed.world().space, patches);
    const std::vector<double> lines = measures_of(posed, cache);
    const std::vector<double> points = area_measures(posed, grid, patches, 150000);
    ASSERT_EQ(lines.size(), points.size());
    double sum = 0, expected = 0, difference = 0;
    for (size_t i = 0; i < lines.size(); ++i) {
        sum += lines[i];
        expected += points[i];
        difference += std::abs(lines[i] - points[i]);
    }
    EXPECT_NEAR(sum / expected, 1, 0.01);
    EXPECT_LT(difference / expected, 0.08);
}

// The measure of a group is that of its shafts together, and of a voxel that of its face pairs.
TEST(Measure, OfGroupsIsTheSumOfTheirMembers) {
    const Scene scene = reference::box_scene({.has_plate = true});
    const Workers workers(2);
    const PosedScene posed(scene, render_space_of(scene, workers), 0, workers);
    const VoxelGrid grid = grid_over(posed.world(), {{2, 2, 2}, 0});
    LightCache cache = full_cache(grid, posed.world().space, 3);
    const std::vector<double> shafts = measures_of(posed, cache);
    const ShaftGroups groups(3, 1);
    std::vector<double> expected(groups.size()), measured(groups.size());
    for (size_t i = 0; i < shafts.size(); ++i) {
        const uint32_t group = groups.of_shaft(cache.shafts[i]);
        expected[group] += shafts[i];
        expected[*groups.of_group(group)] += shafts[i];
    }
    for (size_t g = 0; g < cache.groups.size(); ++g)
        measured[cache.groups[g]] += double(cache.group_measures[g]);
    const double whole = expected.back();
    EXPECT_NEAR(measured.back() / whole, 1, 0.01);
    for (size_t g = 0; g < groups.size(); ++g)
        EXPECT_NEAR(measured[g], expected[g], 0.1 * expected[g] + 1e-3 * whole) << g;
}

TEST(ShaftGroups, HoldTheShaftsBetweenTheirFaces) {
    for (const int patches : {1, 2, 5}) {
        const ShaftGroups groups(patches, 6);
        const uint32_t directed = directed_shaft_count(patches);
        for (uint32_t number = 0; number < 6 * directed; number += 7) {
            const ShaftEnds ends = shaft_ends(number % directed, patches);
            const uint32_t pair = directed_shaft({ends.entry_face, 0, ends.exit_face, 0}, 1);
            const uint32_t group = groups.of_shaft(number);
            EXPECT_EQ(group, pair + 30 * (number / directed));
            const auto voxel = groups.of_group(group);
            ASSERT_TRUE(voxel);
            EXPECT_TRUE(groups.is_voxel(*voxel) && !groups.of_group(*voxel));
            EXPECT_EQ(groups.class_of(*voxel), number / directed);
            EXPECT_EQ(groups.holding(std::vector{number}), (std::vector{group, *voxel}));
        }
    }
}

TEST(VoxelPrimitives, HoldEveryPointOfTheSurfaces) {
    const Scene scene = reference::box_scene({.has_plate = true});
    const Workers workers(2);
    const PosedScene posed(scene, render_space_of(scene, workers), 0, workers);
    const World& world = posed.world();
    const VoxelGrid grid = grid_over(world, {{7, 5, 6}, 0});
    const VoxelPrimitives primitives(world, grid, std::vector<char>(grid.size(), 1), workers);
    CounterRandom random(1);
    for (uint32_t s = 0; s < world.surfaces.size(); ++s)
        for (uint32_t t = 0; t < 2; ++t)
            for (int i = 0; i < 500; ++i) {
                const auto c = triangle_corners(world, s, t);
                const float u = random.next_float(), v = random.next_float();
                const V2f b = square_to_uniform_triangle({u, v});
                const V3f p = c[0] + (c[1] - c[0]) * b.x + (c[2] - c[0]) * b.y;
                const auto place = locate(grid, 1, V3d(p), {0.3, 0.5, 0.7});
                ASSERT_TRUE(place);
                const auto list = primitives.of(place->voxel);
                EXPECT_TRUE(std::find(list.begin(), list.end(), Primitive{s, t}) != list.end());
            }
}

TEST(ShaftHull, HasAtMostTenPlanesAndHoldsItsLines) {
    CounterRandom random(5);
    for (const int patches : {1, 2, 4})
        for (int i = 0; i < 300; ++i) {
            const V3d point(double(random.next_float()), double(random.next_float()),
                            double(random.next_float()));
            const V3d direction =
                V3d(double(random.next_float()) - 0.5, double(random.next_float()) - 0.5,
                    double(random.next_float()) - 0.5)
                    .normalized();
            const VoxelGrid unit;
            const auto place = locate(unit, patches, point, direction);
            ASSERT_TRUE(place);
            const auto hull = shaft_hull(shaft_ends(place->shaft, patches), patches);
            EXPECT_LE(hull.size(), 10u);
            EXPECT_GE(hull.size(), 4u);
            for (const HullPlane& plane : hull)
                EXPECT_LE(plane.normal.dot(point), plane.offset + 1e-9);
            // A small triangle about the point overlaps; one far beyond a plane does not.
            const V3d e(1e-3, 0, 0), f(0, 1e-3, 0);
            EXPECT_TRUE(overlaps_hull(hull, {point, point + e, point + f}));
            const V3d away = hull[0].normal * (3 + hull[0].offset);
            EXPECT_FALSE(overlaps_hull(hull, {away, away + e, away + f}));
        }
}

} // namespace
} // namespace ql
