// Direct light on a Lambert plane against formulas.
#include "reference/scene_builder.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ql {
namespace {

using namespace reference;

constexpr double kPiD = std::numbers::pi;
constexpr double kTolerance = 1e-3; // relative
constexpr V3f kAlbedo(0.8f, 0.5f, 0.2f);

// The plane z = 0 from -4 to 4, lit from above, seen through a narrow view.
struct Plane {
    SceneBuilder builder;

    Plane() {
        builder.add_quad({-4, -4, 0}, {8, 0, 0}, {0, 8, 0}, builder.add_material(lambert(kAlbedo)));
    }
    V3d radiance_at(const V3d& p, int spp) const {
        RenderConfig config;
        config.spp = spp;
        config.path.max_depth = 1;
        const View view{p + V3d(0.5, 0.3, 3), p, 0.002, 8, 8};
        const FrameResult result = render_scene(builder.scene, view, config);
        EXPECT_EQ(result.discarded_samples, 0u);
        return {mean_of(result.image, "R"), mean_of(result.image, "G"), mean_of(result.image, "B")};
    }
};

constexpr std::array<std::array<double, 2>, 5> kPlaces = {
    {{0, 0}, {1, 0}, {-0.3, 2.5}, {3.5, -3.5}, {-2, -1}}};

void expect_irradiance(const V3d& radiance, double irradiance, const V3d& place) {
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(radiance[c], double(kAlbedo[c]) / kPiD * irradiance,
                    kTolerance * (double(kAlbedo[c]) / kPiD * irradiance + 1e-12))
            << "channel " << c << " at " << place.x << ", " << place.y;
}

TEST(ClosedForm, PointLight) {
    Plane plane;
    const V3d light(0.4, -0.2, 1.5);
    plane.builder.place_light(point_light(V3d(7)), translated(light));
    for (const auto& [x, y] : kPlaces) {
        const V3d p(x, y, 0), way = light - p;
        const double d = way.length();
        expect_irradiance(plane.radiance_at(p, 4), 7 * way.z / (d * d * d), p);
    }
}

// A node looks along -z, which is down here.
TEST(ClosedForm, SpotWithTheCosinePowerFalloff) {
    for (const double exponent : {0.0, 1.0, 20.0}) {
        Plane plane;
        const V3d light(0.4, -0.2, 1.5);
        Light spot = point_light(V3d(7));
        spot.kind = Light::Kind::spot;
        spot.exponent = exponent;
        spot.outer_angle = 1.1;
        plane.builder.place_light(spot, translated(light));
        for (const auto& [x, y] : kPlaces) {
            const V3d p(x, y, 0), way = light - p;
            const double d = way.length(), cosine = way.z / d;
            const double falloff = std::acos(cosine) < 1.1 ? std::pow(cosine, exponent) : 0;
            expect_irradiance(plane.radiance_at(p, 4), 7 * falloff * cosine / (d * d), p);
        }
    }
}

// KHR_lights_punctual: ((cos - cos_outer) / (cos_inner - cos_outer))^2, clamped to [0, 1].
TEST(ClosedForm, SpotWithTheSmoothConeFalloff) {
    Plane plane;
    const V3d light(0.4, -0.2, 1.5);
    Light spot = point_light(V3d(7));
    spot.kind = Light::Kind::spot;
    spot.inner_angle = 0.5;
    spot.outer_angle = 1.1;
    // Tilted by 20 degrees about x: the axis leans towards +y.
    plane.builder.place_light(spot, rotated({1, 0, 0}, kPiD / 9) * translated(light));
    const V3d axis(0, std::sin(kPiD / 9), -std::cos(kPiD / 9));
    int lit = 0, dark = 0;
    for (const auto& [x, y] : kPlaces) {
        const V3d p(x, y, 0), way = light - p;
        const double d = way.length();
        const double ramp = std::clamp(
            ((-way / d).dot(axis) - std::cos(1.1)) / (std::cos(0.5) - std::cos(1.1)), 0.0, 1.0);
        ++(ramp > 0 ? lit : dark);
        expect_irradiance(plane.radiance_at(p, 4), 7 * ramp * ramp * way.z / (d * d * d), p);
    }
    EXPECT_GT(lit, 1);
    EXPECT_GT(dark, 0);
}

TEST(ClosedForm, DirectionalLight) {
    Plane plane;
    Light sun = point_light(V3d(3));
    sun.kind = Light::Kind::directional;
    plane.builder.place_light(sun, rotated({1, 0, 0}, 0.6) * rotated({0, 0, 1}, 1.0));
    for (const auto& [x, y] : kPlaces)
        expect_irradiance(plane.radiance_at({x, y, 0}, 4), 3 * std::cos(0.6), {x, y, 0});
}

// Irradiance from a uniform polygon (Lambert 1760): L/2 times the sum over edges of the angle that
// the edge subtends times the cosine between the normal and that of the edge's plane through p.
double polygon_irradiance(const std::vector<V3d>& corners, const V3d& p, const V3d& normal) {
    V3d sum(0);
    for (size_t i = 0; i < corners.size(); ++i) {
        const V3d a = (corners[i] - p).normalized();
        const V3d b = (corners[(i + 1) % corners.size()] - p).normalized();
        const V3d cross = a.cross(b);
        sum += cross.normalized() * std::atan2(cross.length(), a.dot(b));
    }
    return std::abs(sum.dot(normal)) / 2;
}

TEST(ClosedForm, EmissiveTriangle) {
    const std::vector<V3d> corners = {{-0.5, -0.4, 1.6}, {0.1, 0.9, 1.9}, {0.8, -0.3, 1.4}};
    for (const LightSampling sampling : {LightSampling::mis, LightSampling::lights}) {
        Plane plane;
        Material both_sides = emitter(V3f(2));
        both_sides.double_sided = true;
        plane.builder.add_triangle(V3f(corners[0]), V3f(corners[1]), V3f(corners[2]),
                                   plane.builder.add_material(both_sides));
        for (const auto& [x, y] : kPlaces) {
            const V3d p(x, y, 0);
            RenderConfig config;
            config.spp = 16384;
            // Two places are enough for the slower strategy.
            if (sampling == LightSampling::mis && std::abs(x) > 0.5) continue;
            config.path.max_depth = 1;
            config.path.light_sampling = sampling;
            const View above{p + V3d(0.02, 0.03, 0.5), p, 0.002, 8, 8};
            const FrameResult result = render_scene(plane.builder.scene, above, config);
            const V3d radiance(mean_of(result.image, "R"), mean_of(result.image, "G"),
                               mean_of(result.image, "B"));
            expect_irradiance(radiance, 2 * polygon_irradiance(corners, p, {0, 0, 1}), p);
        }
    }
}

V3d radiance_near(const Plane& plane, const V3d& p, LightSampling sampling) {
    RenderConfig config;
    config.spp = 16384;
    config.path.max_depth = 1;
    config.path.light_sampling = sampling;
    const View above{p + V3d(0.02, 0.03, 0.3), p, 0.002, 8, 8};
    const Image image = render_scene(plane.builder.scene, above, config).image;
    return {mean_of(image, "R"), mean_of(image, "G"), mean_of(image, "B")};
}

// A sphere wholly above the horizon lights a surface as its light does from its centre.
TEST(ClosedForm, EmissiveSphere) {
    const V3d centre(0.3, -0.2, 1.7), p(0.9, 0.4, 0);
    const double r = 0.6, d = (centre - p).length();
    Plane plane;
    plane.builder.add_sphere(centre, r, plane.builder.add_material(emitter(V3f(2))));
    for (const LightSampling sampling :
         {LightSampling::mis, LightSampling::lights, LightSampling::bsdf}) {
        const V3d found = radiance_near(plane, p, sampling);
        const double expected = double(kAlbedo.x) * 2 * (r * r) / (d * d) * ((centre - p).z / d);
        EXPECT_NEAR(found.x / expected, 1, 0.004) << int(sampling);
    }
}

// Stretched, turned and mirrored: what points on the shape find is what directions find.
TEST(ClosedForm, EmissiveShapesAreSampledAsTheyAre) {
    ImplicitShape ball, cone;
    cone.kind = ImplicitShape::Kind::cone;
    cone.radius_top = 0.2f;
    const M44d placed =
        scaled({-1, 0.3, 0.7}) * rotated({0.4, 0.2, 1}, 0.8) * translated({0.1, 0.2, 1.2});
    for (ImplicitShape shape : {ball, cone}) {
        Plane plane;
        shape.material = plane.builder.add_material(emitter(V3f(2)));
        plane.builder.place_shape(shape, placed);
        const V3d p(0.4, -0.1, 0);
        const double by_points = radiance_near(plane, p, LightSampling::lights).x;
        const double by_directions = radiance_near(plane, p, LightSampling::bsdf).x;
        EXPECT_GT(by_points, 0.01);
        EXPECT_NEAR(by_points / by_directions, 1, 0.006);
        EXPECT_NEAR(radiance_near(plane, p, LightSampling::mis).x / by_directions, 1, 0.006);
    }
}

TEST(ClosedForm, BlendedScreenPassesItsShareOfLight) {
    for (const float alpha : {0.0f, 0.3f, 1.0f}) {
        Plane plane;
        plane.builder.place_light(point_light(V3d(7)), translated({0, 0, 2}));
        Material screen = lambert(V3f(0));
        screen.alpha_mode = AlphaMode::blend;
        screen.alpha = alpha;
        plane.builder.add_quad({-1, -1, 1}, {2, 0, 0}, {0, 2, 0},
                               plane.builder.add_material(screen));
        RenderConfig config;
        config.spp = 4096;
        config.path.max_depth = 1;
        const V3d below(0.2, 0.05, 0); // not under the diagonal of the screen
        const View below_screen{below + V3d(0.02, 0.03, 0.5), below, 0.002, 8, 8};
        const FrameResult result = render_scene(plane.builder.scene, below_screen, config);
        const double distance = V3d(0.2, 0.05, 2).length();
        const double expected = double(kAlbedo.x) / kPiD * 7 * 2 /
                                (distance * distance * distance) * (1 - double(alpha));
        EXPECT_NEAR(mean_of(result.image, "R"), expected, 5e-3 * (expected + 1e-9));
    }
}

} // namespace
} // namespace ql
