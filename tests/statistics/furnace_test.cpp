// In a surrounding of radiance 1 a surface that absorbs nothing cannot be seen.
#include "reference/scene_builder.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ql {
namespace {

using namespace reference;

constexpr double kTolerance = 0.002;

RenderConfig furnace_config(int spp, int max_depth, int roulette_depth) {
    RenderConfig config;
    config.spp = spp;
    config.path.max_depth = max_depth;
    config.path.roulette_depth = roulette_depth;
    config.path.sky = V3f(1);
    return config;
}

// A deep box, open towards the viewer: most paths scatter several times.
Scene open_box(const Material& material) {
    SceneBuilder b;
    Mesh box = cube(1, b.add_material(material));
    box.triangles.resize(10); // the side at +z comes last
    b.scene.meshes.push_back(box);
    b.place_mesh(0);
    return b.scene;
}

Scene one_sphere(const Material& material) {
    SceneBuilder b;
    b.add_sphere(V3d(0), 1, b.add_material(material));
    return b.scene;
}

Scene one_cube(const Material& material) {
    SceneBuilder b;
    b.scene.meshes.push_back(cube(1, b.add_material(material)));
    b.place_mesh(0, rotated(V3d(1, 2, 3).normalized(), 0.7));
    return b.scene;
}

void expect_invisible(const Scene& scene, const RenderConfig& config, double tolerance) {
    const FrameResult result = render_scene(scene, {{0.3, 0.2, 4}, {0, 0, 0}, 36, 32, 32}, config);
    EXPECT_EQ(result.discarded_samples, 0u);
    for (const char* channel : {"R", "G", "B"})
        EXPECT_NEAR(mean_of(result.image, channel), 1, tolerance);
}

TEST(Furnace, LambertIsInvisibleAlongEveryPath) {
    expect_invisible(open_box(lambert(V3f(1))), furnace_config(32, 1000, 0), 1e-5);
}

TEST(Furnace, LambertIsInvisibleWithRoulette) {
    expect_invisible(open_box(lambert(V3f(1))), furnace_config(512, 1000, 2), kTolerance);
}

TEST(Furnace, MirrorsAreInvisible) {
    expect_invisible(open_box(mirror()), furnace_config(16, 1000, 0), 1e-5);
    expect_invisible(one_sphere(mirror()), furnace_config(16, 10, 0), 1e-5);
}

TEST(Furnace, SmoothDielectricsAreInvisible) {
    for (const float ior : {1.0f, 1.000001f, 1.5f, 3.0f}) {
        SCOPED_TRACE(ior);
        expect_invisible(one_sphere(glass(ior)), furnace_config(128, 1000, 0), kTolerance);
        expect_invisible(one_cube(glass(ior)), furnace_config(128, 1000, 0), kTolerance);
    }
    expect_invisible(one_sphere(glass(100)), furnace_config(32, 4000, 0), kTolerance);
}

TEST(Furnace, ThinGlassOfMetallicRoughnessIsInvisible) {
    Material m = metal(0);
    m.metallic = 0;
    m.transmission = 1;
    expect_invisible(one_sphere(m), furnace_config(64, 1000, 0), kTolerance);
}

// Radiance e from walls of albedo a adds up to e / (1 - a).
TEST(Furnace, ClosedBoxOfEmittersGivesTheGeometricSeries) {
    SceneBuilder b;
    b.scene.meshes.push_back(
        cube(1, b.add_material(emitter(V3f(0.5f, 0.25f, 0.75f), V3f(0.5f, 0.75f, 0.25f)))));
    b.scene.materials[0].double_sided = true;
    b.place_mesh(0);
    for (const LightSampling sampling :
         {LightSampling::mis, LightSampling::lights, LightSampling::bsdf}) {
        RenderConfig config = furnace_config(256, 200, 4);
        config.path.light_sampling = sampling;
        const View inside = {{0.2, 0.1, 0.9}, {0, 0, 0}, 80, 32, 32};
        const FrameResult result = render_scene(b.scene, inside, config);
        // Points on lights alone have no finite variance where walls meet: 1 / r^2.
        const double tolerance = sampling == LightSampling::lights ? 0.01 : kTolerance;
        for (const char* channel : {"R", "G", "B"})
            EXPECT_NEAR(mean_of(result.image, channel), 1, tolerance)
                << channel << " sampling " << int(sampling);
    }
}

// Directional albedo of single-scattering GGX with F = 1: integral over half vectors,
// int D cos_h [G2 (o.h) / (cos_o cos_h)] dh with D cos_h sampled by its inverse (Walter 2007,
// eq. 35), G2 = 1 / (1 + Lambda_o + Lambda_i) (Heitz 2014, eq. 99).
double ggx_albedo(double cos_o, double alpha) {
    constexpr int kSteps = 600;
    const auto lambda = [&](double cosine) {
        const double tan2 = 1 / (cosine * cosine) - 1;
        return (std::sqrt(1 + alpha * alpha * tan2) - 1) / 2;
    };
    const V3d o(std::sqrt(1 - cos_o * cos_o), 0, cos_o);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j) {
            const double u = (i + 0.5) / kSteps;
            const double phi = 2 * std::numbers::pi * (j + 0.5) / kSteps;
            const double cos_h = 1 / std::sqrt(1 + alpha * alpha * u / (1 - u));
            const double sin_h = std::sqrt(1 - cos_h * cos_h);
            const V3d h(sin_h * std::cos(phi), sin_h * std::sin(phi), cos_h);
            const double oh = o.dot(h);
            const double cos_i = 2 * oh * cos_h - cos_o;
            if (oh <= 0 || cos_i <= 0) continue;
            sum += oh / ((1 + lambda(cos_o) + lambda(cos_i)) * cos_o * cos_h);
        }
    return sum / (double(kSteps) * kSteps);
}

TEST(Furnace, GgxLosesItsSingleScatterShare) {
    for (const double roughness : {0.1, 0.3, 0.6, 1.0})
        for (const double degrees : {0.0, 60.0, 80.0}) {
            SceneBuilder b;
            b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(metal(float(roughness))));
            const double angle = degrees * std::numbers::pi / 180;
            View view{V3d(std::sin(angle), 0, std::cos(angle)) * 100, {0, 0, 0}, 0.01, 32, 32};
            const FrameResult result = render_scene(b.scene, view, furnace_config(256, 5, 0));
            EXPECT_NEAR(mean_of(result.image, "G"),
                        ggx_albedo(std::cos(angle), roughness * roughness), kTolerance)
                << "roughness " << roughness << ", " << degrees << " degrees";
        }
}

} // namespace
} // namespace ql
