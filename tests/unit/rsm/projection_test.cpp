#include "rsm/projection.h"

#include "base/error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

constexpr double kPiD = std::numbers::pi;

MapLight spot(double outer_degrees) {
    MapLight light;
    light.kind = Light::Kind::spot;
    light.position = {0.1f, -0.2f, 0.3f};
    light.axis = V3f(0.3f, -0.5f, 0.7f).normalized();
    light.intensity = V3f(1);
    light.outer_angle = outer_degrees / 180 * kPiD;
    light.cone = spot_cone(0, light.outer_angle, 0);
    return light;
}

MapLight of_kind(Light::Kind kind) {
    MapLight light = spot(40);
    light.kind = kind;
    return light;
}

World unit_world() {
    World world;
    world.bounds = {V3d(-0.5, -0.3, -0.4), V3d(0.5, 0.3, 0.4)};
    return world;
}

// angle: radians; directions are good to some 1e-7, which is much of a narrow cone.
void expect_round_trip(const MapProjection& projection, double angle = 1) {
    const double tolerance = std::max(2e-5, 5e-7 / angle);
    for (double v = 0.05; v < 1; v += 0.09)
        for (double u = 0.05; u < 1; u += 0.09) {
            const auto view = projection.ray(u, v);
            EXPECT_NEAR(view.ray.direction.length(), 1, 1e-6);
            const auto at = projection.point(view.ray.origin + view.ray.direction * 1.7f);
            ASSERT_NEAR(at.uv.x, u, tolerance);
            ASSERT_NEAR(at.uv.y, v, tolerance);
            EXPECT_NEAR(at.depth, 1.7, 1e-5);
            EXPECT_TRUE(at.is_ahead);
            EXPECT_NEAR(projection.measure(at) / view.measure, 1, 1e-3);
        }
}

double total_measure(const MapProjection& projection) {
    double sum = 0;
    constexpr int n = 64;
    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x)
            sum += projection.ray((x + 0.5) / n, (y + 0.5) / n).measure / (n * n);
    return sum;
}

TEST(RsmProjection, PointsOnARayLieWhereTheRayCameFrom) {
    const World world = unit_world();
    for (const double degrees : {0.01, 20.0, 60.0, 89.0, 90.0, 120.0, 179.0})
        expect_round_trip(map_projections(spot(degrees), MapKind::equal_area, world)[0],
                          degrees / 180 * kPiD);
    for (const double degrees : {1.0, 45.0, 80.0})
        expect_round_trip(map_projections(spot(degrees), MapKind::perspective, world)[0],
                          degrees / 180 * kPiD);
    for (const auto kind : {Light::Kind::point, Light::Kind::directional})
        for (const auto map : {MapKind::equal_area, MapKind::perspective})
            for (const MapProjection& p : map_projections(of_kind(kind), map, world))
                expect_round_trip(p);
}

TEST(RsmProjection, TexelsOfEqualAreaMapsShareTheConeOrTheSphereEvenly) {
    for (const double degrees : {0.1, 30.0, 90.0, 150.0}) {
        const auto p = map_projections(spot(degrees), MapKind::equal_area, unit_world())[0];
        const double s = std::sin(degrees / 360 * kPiD);
        EXPECT_NEAR(total_measure(p) / (4 * kPiD * s * s), 1, 1e-5) << degrees;
        EXPECT_EQ(p.ray(0.1, 0.9).measure, p.ray(0.5, 0.5).measure);
    }
    const auto sphere =
        map_projections(of_kind(Light::Kind::point), MapKind::equal_area, unit_world());
    ASSERT_EQ(sphere.size(), 1u);
    EXPECT_NEAR(total_measure(sphere[0]), 4 * kPiD, 1e-4);
}

TEST(RsmProjection, SixPerspectiveFacesCoverTheSphereOnce) {
    const auto faces =
        map_projections(of_kind(Light::Kind::point), MapKind::perspective, unit_world());
    ASSERT_EQ(faces.size(), 6u);
    double sum = 0;
    for (const MapProjection& face : faces)
        sum += total_measure(face);
    EXPECT_NEAR(sum / (4 * kPiD), 1, 1e-3);
}

TEST(RsmProjection, DirectionalMapsCoverTheBounds) {
    const World world = unit_world();
    const auto p =
        map_projections(of_kind(Light::Kind::directional), MapKind::equal_area, world)[0];
    for (int corner = 0; corner < 8; ++corner) {
        const V3f at(corner & 1 ? 0.5f : -0.5f, corner & 2 ? 0.3f : -0.3f,
                     corner & 4 ? 0.4f : -0.4f);
        const auto point = p.point(at);
        EXPECT_GE(point.uv.x, -1e-6);
        EXPECT_LE(point.uv.x, 1 + 1e-6);
        EXPECT_GE(point.uv.y, -1e-6);
        EXPECT_LE(point.uv.y, 1 + 1e-6);
        EXPECT_GT(point.depth, 0);
    }
}

TEST(RsmProjection, ConesNoPerspectiveMapCanHoldAreRefused) {
    EXPECT_THROW(map_projections(spot(90), MapKind::perspective, unit_world()), Error);
}

TEST(RsmProjection, VerticalLightsHaveAViewToo) {
    MapLight light = spot(30);
    light.axis = {0, -1, 0};
    expect_round_trip(map_projections(light, MapKind::equal_area, unit_world())[0]);
    expect_round_trip(map_projections(light, MapKind::perspective, unit_world())[0]);
}

} // namespace
} // namespace ql
