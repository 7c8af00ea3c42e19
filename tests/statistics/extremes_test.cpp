// The laws of invariance_test.cpp for the other renderers, over the ranges that the manual pages
// promise, and the ends of these laws.
#include "linespace/inject.h"
#include "linespace/sample.h"
#include "reference/linespace_scenes.h"
#include "reference/scene_builder.h"
#include "render/film.h"
#include "rsm/render.h"
#include "sampling/seeds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ql {
namespace {

using namespace reference;

const Workers kWorkers(1);

// Everything `size` times as long and moved, candela times size^2 and times `light`.
struct Change {
    double size = 1;
    V3d shift = {0, 0, 0};
    double light = 1;
};

Scene changed(Scene scene, const Change& change) {
    const M44d by = scaled(V3d(change.size)) * translated(change.shift);
    const std::vector<M44d> poses = world_from_nodes(scene, 0);
    for (size_t i = 0; i < poses.size(); ++i) {
        scene.nodes[i].matrix = poses[i] * by;
        scene.nodes[i].parent = -1;
    }
    for (Light& light : scene.lights)
        light.intensity *= change.size * change.size * change.light;
    return scene;
}

// A box of one metre with a lamp in it.
Scene room() {
    return box_scene(
        {.albedo = 0.7f, .left = V3f(0.6f, 0.1f, 0.1f), .lights = {{{0.5, 0.8, 0.5}, 1}}});
}

struct Stage {
    Scene scene;
    RenderSpace space = render_space_of(scene, kWorkers);
    PosedScene posed{scene, space, 0, kWorkers};
    PixelCamera camera;

    explicit Stage(const Change& change)
        : scene(changed(room(), change)),
          camera(camera_of({V3d(0.5, 0.7, 0.97) * change.size + change.shift,
                            V3d(0.45, 0.25, 0) * change.size + change.shift, 75, 12, 12},
                           scene, space)) {}
};

LightCache injected(const Stage& stage) {
    InjectConfig config;
    config.grid.voxels = {5, 5, 5};
    config.photons = {0, 20000};
    Progress quiet;
    InjectReport report;
    return inject(stage.posed, 1, config, kWorkers, quiet, report);
}

Image sampled(const Change& change) {
    const Stage stage(change);
    const LightCache cache = injected(stage);
    const ReadTable table(cache, stage.space, stage.posed.lights(), {1}, kWorkers);
    SampleConfig config;
    config.read.max_depth = cache.header.max_depth;
    Progress quiet;
    return sample_frame(stage.posed, stage.camera, table, nullptr, nullptr,
                        fresh_seeds(1, 0, 12, 12), config, kWorkers, quiet)
        .image;
}

Image gathered(const Change& change) {
    const Stage stage(change);
    RsmConfig config;
    config.map.size = 24;
    config.gather.samples = 64;
    Progress quiet;
    RsmRenderer renderer(stage.posed, stage.camera, 12, 12, config, kWorkers, quiet);
    renderer.prepare_pass();
    renderer.render_pass();
    return renderer.image();
}

using Renderer = Image (*)(const Change& change);
constexpr std::pair<const char*, Renderer> kRenderers[] = {{"Linespace", sampled},
                                                           {"maps", gathered}};

// Rounding may send a path, or a photon, another way: the mean stays.
void expect_same_mean(const Image& image, const Image& expected, double tolerance) {
    for (const char* channel : {"R", "G", "B"})
        EXPECT_NEAR(mean_of(image, channel) / mean_of(expected, channel), 1, tolerance);
}

TEST(Extremes, TheUnitOfLengthChangesRoundingAlone) {
    for (const auto& [name, render] : kRenderers) {
        const Image metres = render({});
        for (const double size : {1e-6, 1e-3, 1e3, 1e6}) {
            SCOPED_TRACE(fmt::format("{} {}", name, size));
            expect_same_mean(render({.size = size}), metres, 2e-3);
        }
    }
}

TEST(Extremes, ThePlaceOfTheSceneChangesRoundingAlone) {
    for (const auto& [name, render] : kRenderers) {
        const Image here = render({});
        for (const V3d& there : {V3d(1e4, -2e4, 1.5e4), V3d(1e6, 3e6, -1e6)}) {
            SCOPED_TRACE(fmt::format("{} {}", name, there.x));
            expect_same_mean(render({.shift = there}), here, 2e-3);
        }
    }
}

TEST(Extremes, LightScalesExactlyByPowersOfTwo) {
    for (const auto& [name, render] : kRenderers) {
        const Image one = render({});
        for (const int power : {-99, -1, 3, 99}) {
            const Image other = render({.light = std::ldexp(1.0, power)});
            for (const Plane<float>& plane : one.planes)
                for (size_t i = 0; i < plane.pixels.size(); ++i)
                    ASSERT_EQ(std::ldexp(plane.pixels[i], power), (*other.find(plane.name))[i])
                        << name << " 2^" << power;
        }
    }
}

TEST(Extremes, SumsOfACacheKnowNeitherTheUnitOfLightNorPowersOfTwoOfLength) {
    const LightCache one = injected(Stage({}));
    ASSERT_GT(one.size(), 1000u);
    for (const Change& change : {Change{.light = 0x1p-99}, Change{.light = 0x1p99},
                                 Change{.size = 0x1p-20}, Change{.size = 0x1p20}}) {
        const LightCache other = injected(Stage(change));
        EXPECT_EQ(other.shafts, one.shafts);
        EXPECT_EQ(other.sums, one.sums);
        EXPECT_EQ(other.counts, one.counts);
        EXPECT_EQ(other.header.unit, one.header.unit * change.light * change.size * change.size);
    }
}

// --- Where the laws end --------------------------------------------------------------------------

std::string refusal(const Scene& scene, double time = 0) {
    try {
        const RenderSpace space = render_space_of(scene, kWorkers);
        const PosedScene posed(scene, space, time, kWorkers);
        return "";
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input);
        return error.what();
    }
}

TEST(Extremes, ScenesFrom1e15To1e15MetresAreTaken) {
    for (const double size : {2e-15, 1e-10, 1e10, 0.9e15})
        EXPECT_EQ(refusal(changed(room(), {.size = size})), "") << size;
    for (const double size : {1e-38, 0.5e-15, 2e15, 1e30})
        EXPECT_NE(refusal(changed(room(), {.size = size})).find("expected 1e-15 to 1e+15 m"),
                  std::string::npos)
            << size;
}

TEST(Extremes, TransformsHoldNumbersUpTo1e100) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(0.5f))));
    b.place_light(point_light(V3d(1)), scaled({1, 1, 1e99}));
    EXPECT_EQ(refusal(b.scene), "");
    for (const double entry : {1e101, std::numeric_limits<double>::infinity(), std::nan("")}) {
        b.scene.nodes.back().matrix = scaled({1, 1, entry});
        EXPECT_NE(refusal(b.scene).find("in its transform"), std::string::npos) << entry;
    }
}

TEST(Extremes, LightsMayBe1e15TimesAsFarAwayAsTheSceneIsWide) {
    for (const double distance : {1e3, 1e14}) {
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(0.5f))));
        b.place_light(point_light(V3d(distance * distance)), translated({0, 0, distance}));
        const FrameResult result = render_scene(b.scene, {{0, 0, 4}, {0, 0, 0}, 20, 4, 4}, {});
        EXPECT_NEAR(mean_of(result.image, "R") * 3.14159265 / 0.5, 1, 1e-4) << distance;
        b.scene.nodes.back().matrix = translated({0, 0, 4e15});
        EXPECT_NE(refusal(b.scene).find("expected at most 1e+15"), std::string::npos);
    }
}

TEST(Extremes, ThingsMayMove1e8TimesTheExtentOfTheScene) {
    for (const auto& [way, taken] : {std::pair{1e7, true}, {1e9, false}, {1e30, false}}) {
        Scene scene = room();
        Node& node = scene.nodes.front();
        node.matrix.reset();
        AnimationChannel channel;
        channel.times = {0, 1};
        channel.values = {{0, 0, 0, 0}, {way, 0, 0, 0}};
        scene.animation = {channel};
        EXPECT_EQ(refusal(scene, 1).empty(), taken) << way;
    }
}

TEST(Extremes, LightBrighterThanFloatBecomesTheGreatestFloat) {
    constexpr float kMost = std::numeric_limits<float>::max();
    EXPECT_EQ(saturated(1e39), kMost);
    EXPECT_EQ(saturated(-std::numeric_limits<double>::infinity()), -kMost);
    EXPECT_EQ(saturated(0.1), 0.1f);
    for (const auto& [name, render] : kRenderers) {
        size_t saturated_samples = 0;
        for (const Plane<float>& plane : render({.light = 1e40}).planes)
            for (const float value : plane.pixels.values()) {
                EXPECT_TRUE(std::isfinite(value) && value >= 0) << name << ' ' << plane.name;
                saturated_samples += value == kMost;
            }
        EXPECT_GT(saturated_samples, 100u) << name;
    }
}

TEST(Extremes, RaysOfCamerasFarAsideStayWithinTheRangeOfFloat) {
    const Stage stage({});
    for (const double far : {1e3, 1e12, 1e30, 1e90}) {
        const PixelCamera camera = camera_of({V3d(far, far, 2 * far), V3d(far, far, 0), 60, 4, 4},
                                             stage.scene, stage.space);
        const Ray ray = camera.ray(1.5, 2);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_LE(std::abs(ray.origin[axis]), 1e15f) << far;
        Hit hit;
        EXPECT_FALSE(stage.posed.rays().intersect(ray, 0, hit));
    }
}

} // namespace
} // namespace ql
