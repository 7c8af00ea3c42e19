#include "scene/scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

using Path = AnimationChannel::Path;
using Interpolation = AnimationChannel::Interpolation;

Scene moved_node(Path path, Interpolation interpolation, std::vector<double> times,
                 std::vector<std::array<double, 4>> values) {
    Scene scene;
    scene.nodes.resize(1);
    scene.animation.push_back({0, path, interpolation, std::move(times), std::move(values)});
    return scene;
}

V3d origin_at(const Scene& scene, double time) {
    return V3d(0) * world_from_nodes(scene, time)[0];
}

V3d x_axis_at(const Scene& scene, double time) {
    V3d axis;
    world_from_nodes(scene, time)[0].multDirMatrix(V3d(1, 0, 0), axis);
    return axis;
}

std::array<double, 4> about_z(double angle) {
    return {0, 0, std::sin(angle / 2), std::cos(angle / 2)};
}

TEST(Animation, LinearTranslationIsAStraightLineHeldAtBothEnds) {
    const Scene scene = moved_node(Path::translation, Interpolation::linear, {1, 2, 4},
                                   {{0, 0, 0}, {2, 0, 0}, {2, 4, 0}});
    EXPECT_EQ(origin_at(scene, 0), V3d(0));
    EXPECT_EQ(origin_at(scene, 1.25), V3d(0.5, 0, 0));
    EXPECT_EQ(origin_at(scene, 2), V3d(2, 0, 0));
    EXPECT_EQ(origin_at(scene, 3.5), V3d(2, 3, 0));
    EXPECT_EQ(origin_at(scene, 9), V3d(2, 4, 0));
}

TEST(Animation, StepsHoldTheirValueUntilTheNextKey) {
    const Scene scene =
        moved_node(Path::translation, Interpolation::step, {0, 1}, {{1, 0, 0}, {2, 0, 0}});
    EXPECT_EQ(origin_at(scene, 0.999), V3d(1, 0, 0));
    EXPECT_EQ(origin_at(scene, 1), V3d(2, 0, 0));
}

TEST(Animation, LinearRotationHasConstantSpeed) {
    for (const double angle : {1e-9, 0.5, 2.0, 3.0}) {
        const Scene scene =
            moved_node(Path::rotation, Interpolation::linear, {0, 1}, {about_z(0), about_z(angle)});
        for (const double t : {0.0, 0.25, 0.5, 0.9, 1.0}) {
            const V3d axis = x_axis_at(scene, t);
            EXPECT_NEAR(axis.x, std::cos(t * angle), 1e-15);
            EXPECT_NEAR(axis.y, std::sin(t * angle), 1e-15 + 1e-9 * angle);
        }
    }
}

TEST(Animation, RotationTakesTheShorterWay) {
    const Scene scene = moved_node(Path::rotation, Interpolation::linear, {0, 1},
                                   {about_z(0), about_z(1.5 * std::numbers::pi)});
    EXPECT_NEAR(x_axis_at(scene, 0.5).y, -std::sqrt(0.5), 1e-15);
}

TEST(Animation, QuaternionsNeedNotBeOfUnitLength) {
    std::array<double, 4> twice = about_z(1);
    for (double& c : twice)
        c *= 2;
    const Scene scene =
        moved_node(Path::rotation, Interpolation::linear, {0, 1}, {about_z(0), twice});
    EXPECT_NEAR(x_axis_at(scene, 0.5).y, std::sin(0.5), 1e-15);
    EXPECT_NEAR(x_axis_at(scene, 1).length(), 1, 1e-15);
}

// A cubic Hermite spline reproduces every cubic polynomial.
TEST(Animation, CubicSplineReproducesACubic) {
    const auto p = [](double t) { return 1 + 2 * t - 3 * t * t + 0.5 * t * t * t; };
    const auto slope = [](double t) { return 2 - 6 * t + 1.5 * t * t; };
    std::vector<std::array<double, 4>> values;
    const std::vector<double> times = {0, 0.5, 3};
    for (const double t : times) {
        values.push_back({slope(t), 0, 0});
        values.push_back({p(t), 0, 0});
        values.push_back({slope(t), 0, 0});
    }
    const Scene scene = moved_node(Path::translation, Interpolation::cubic_spline, times, values);
    for (const double t : {0.0, 0.1, 0.5, 1.0, 2.7, 3.0})
        EXPECT_NEAR(origin_at(scene, t).x, p(t), 1e-13) << t;
}

TEST(Animation, ScaleComesBeforeRotationBeforeTranslation) {
    Scene scene = moved_node(Path::scale, Interpolation::linear, {0, 1}, {{1, 1, 1}, {3, 1, 1}});
    scene.nodes[0].translation = V3d(0, 0, 5);
    scene.nodes[0].rotation = Imath::Quatd(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
    const V3d moved = V3d(1, 0, 0) * world_from_nodes(scene, 0.5)[0];
    EXPECT_LT((moved - V3d(0, 2, 5)).length(), 1e-14);
}

TEST(Animation, ChildrenFollowTheirParents) {
    Scene scene =
        moved_node(Path::translation, Interpolation::linear, {0, 1}, {{0, 0, 0}, {1, 0, 0}});
    scene.nodes.resize(2);
    scene.nodes[1].parent = 0;
    scene.nodes[1].translation = V3d(0, 7, 0);
    EXPECT_EQ(V3d(0) * world_from_nodes(scene, 0.5)[1], V3d(0.5, 7, 0));
}

TEST(Animation, FarFromTheOriginDoublePrecisionRemains) {
    Scene scene = moved_node(Path::translation, Interpolation::linear, {0, 1},
                             {{1e6, 0, 0}, {1e6 + 1e-3, 0, 0}});
    EXPECT_NEAR(origin_at(scene, 0.5).x - 1e6, 5e-4, 1e-9);
}

} // namespace
} // namespace ql
