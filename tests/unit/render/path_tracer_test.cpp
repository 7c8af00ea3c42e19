#include "render/path_tracer.h"

#include "metrics/statistics.h"
#include "reference/scene_builder.h"
#include "sampling/seeds.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

using namespace reference;

Scene lit_box() {
    SceneBuilder b;
    b.scene = cornell(glass(1.45f), emitter(V3f(12, 10, 8)));
    b.place_light(point_light(V3d(0.1, 0.2, 0.3)), translated({0.3, 0.2, 0.3}));
    return b.scene;
}

void expect_same_bytes(const Image& a, const Image& b) {
    ASSERT_EQ(a.planes.size(), b.planes.size());
    for (const Plane<float>& plane : a.planes)
        EXPECT_TRUE(plane.pixels == *b.find(plane.name)) << plane.name;
    for (const Plane<uint32_t>& plane : a.uint_planes)
        EXPECT_TRUE(plane.pixels == *b.find_uint(plane.name)) << plane.name;
}

constexpr uint32_t kAllAovs = 0x1ff;

TEST(PathTracer, ThreadsChangeNoByte) {
    RenderConfig config;
    config.spp = 4;
    config.aovs = kAllAovs;
    View view = cornell_view(50); // not a multiple of the tile
    view.height = 37;
    const FrameResult one = render_scene(lit_box(), view, config, 3, 1);
    const FrameResult two = render_scene(lit_box(), view, config, 3, 2);
    const FrameResult again = render_scene(lit_box(), view, config, 3, 3);
    expect_same_bytes(one.image, two.image);
    expect_same_bytes(one.image, again.image);
    EXPECT_EQ(one.rays.shadow, two.rays.shadow);
    EXPECT_EQ(one.rays.indirect, again.rays.indirect);
    EXPECT_EQ(one.rays.camera, 50u * 37u * 4u);
}

TEST(PathTracer, OtherSeedsGiveAnotherImage) {
    const RenderConfig config;
    const Image a = render_scene(lit_box(), cornell_view(16), config, 1).image;
    const Image b = render_scene(lit_box(), cornell_view(16), config, 2).image;
    EXPECT_FALSE(*a.find("R") == *b.find("R"));
}

FrameResult render_with_seeds(const Scene& scene, const View& view, const RenderConfig& config,
                              const Array2D<uint32_t>& seeds) {
    const Workers workers(1);
    Progress progress;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    return render_frame(posed, camera_of(view, scene, space), seeds, config, nullptr, workers,
                        progress);
}

// Far away from a wide wall under an even light every pixel sees the same: the value follows from
// the seed alone, wherever it lies.
TEST(PathTracer, ASeedTakesItsValueAlongToAnotherPixel) {
    SceneBuilder b;
    b.add_quad({-500, -500, 0}, {1000, 0, 0}, {0, 1000, 0}, b.add_material(lambert(V3f(0.5f))));
    b.add_quad({-500, -500, 900}, {0, 1000, 0}, {1000, 0, 0}, b.add_material(emitter(V3f(1))));
    const View view{{0, 0, 500}, {0, 0, 0}, 0.001, 9, 7};
    RenderConfig config;
    config.spp = 2;
    config.path.light_sampling = LightSampling::bsdf;
    config.path.max_depth = 1;
    const Array2D<uint32_t> seeds = fresh_seeds(5, 0, 9, 7);
    Array2D<uint32_t> moved(9, 7);
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x)
            moved(wrap(x + 1, 9), wrap(y + 2, 7)) = seeds(x, y);
    const Array2D<float> before = *render_with_seeds(b.scene, view, config, seeds).image.find("R");
    const Array2D<float> after = *render_with_seeds(b.scene, view, config, moved).image.find("R");
    int dark = 0;
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x) {
            EXPECT_NEAR(after(wrap(x + 1, 9), wrap(y + 2, 7)), before(x, y), 1e-4);
            dark += before(x, y) < 0.3f;
        }
    EXPECT_GT(dark, 3); // values differ between pixels: some paths miss the light
    EXPECT_LT(dark, 60);
}

TEST(PathTracer, EqualSeedsGiveEqualRandomNumbersInEveryPixel) {
    SceneBuilder b;
    b.add_quad({-500, -500, 0}, {1000, 0, 0}, {0, 1000, 0}, b.add_material(lambert(V3f(0.5f))));
    b.add_quad({-500, -500, 900}, {0, 1000, 0}, {1000, 0, 0}, b.add_material(emitter(V3f(1))));
    const View view{{0, 0, 500}, {0, 0, 0}, 0.001, 8, 8};
    RenderConfig config;
    config.path.max_depth = 3;
    const Image image = render_with_seeds(b.scene, view, config, Array2D<uint32_t>(8, 8, 77)).image;
    for (const float value : image.find("R")->values())
        EXPECT_NEAR(value, (*image.find("R"))[0], 1e-4f);
}

TEST(PathTracer, DirectAndIndirectAddUp) {
    RenderConfig config;
    config.spp = 8;
    config.aovs = kAovDirect | kAovIndirect;
    const Image image = render_scene(lit_box(), cornell_view(24), config).image;
    config.path.max_depth = 1;
    const Image shallow = render_scene(lit_box(), cornell_view(24), config).image;
    for (const char* c : {"R", "G", "B"}) {
        const auto &all = *image.find(c), &direct = *image.find(std::string("direct.") + c),
                   &indirect = *image.find(std::string("indirect.") + c);
        for (size_t i = 0; i < all.size(); ++i) {
            EXPECT_NEAR(all[i], direct[i] + indirect[i], 1e-6f * (1 + all[i]));
            EXPECT_EQ((*shallow.find(std::string("indirect.") + c))[i], 0);
            EXPECT_NEAR((*shallow.find(c))[i], direct[i], 1e-6f * (1 + direct[i]));
        }
        EXPECT_GT(mean_of(image, (std::string("indirect.") + c).c_str()), 0.01);
    }
}

// The same light without the noise of the choice.
TEST(PathTracer, AllLightsAtTheFirstVertexChangeNothingButTheNoise) {
    SceneBuilder b;
    b.scene = cornell(lambert(V3f(0.5f)), emitter(V3f(12, 10, 8)));
    b.place_light(point_light(V3d(1, 2, 3)), translated({0.3, 0.3, 0.3}));
    RenderConfig config;
    config.spp = 64;
    config.path.max_depth = 1;
    config.aovs = kAovVariance;
    const FrameResult one = render_scene(b.scene, cornell_view(24), config);
    config.path.all_lights = true;
    const FrameResult each = render_scene(b.scene, cornell_view(24), config);
    for (const char* channel : {"R", "B"})
        EXPECT_NEAR(mean_of(each.image, channel) / mean_of(one.image, channel), 1, 0.01);
    EXPECT_LT(mean_of(each.image, "variance.B"), 0.5 * mean_of(one.image, "variance.B"));
    EXPECT_EQ(each.rays.camera, one.rays.camera);
    EXPECT_GT(each.rays.shadow, 1.5 * double(one.rays.shadow));
}

// The variance channel says how far means of other seeds scatter.
TEST(PathTracer, VarianceChannelIsTheVarianceOfTheMean) {
    RenderConfig config;
    config.spp = 8;
    config.aovs = kAovVariance;
    const Scene scene = cornell(lambert(V3f(0.5f)), emitter(V3f(12)));
    constexpr int kRenders = 48;
    double claimed = 0, found = 0;
    std::vector<std::vector<double>> values(16 * 16);
    for (uint64_t seed = 0; seed < kRenders; ++seed) {
        const Image image = render_scene(scene, cornell_view(16), config, seed).image;
        claimed += mean_of(image, "variance.G") / kRenders;
        for (size_t i = 0; i < values.size(); ++i)
            values[i].push_back(double((*image.find("G"))[i]));
    }
    for (const auto& pixel : values)
        found += sample_moments(pixel).variance / double(values.size());
    EXPECT_NEAR(claimed / found, 1, 0.1);
}

// A floor one metre below the camera, seen straight down: everything follows from the pixel.
TEST(PathTracer, SurfaceChannelsAgreeWithProjectionByHand) {
    SceneBuilder b;
    b.add_quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, b.add_material(lambert({0.1f, 0.5f, 0.9f})));
    b.place_light(point_light(V3d(1)), translated({0, 0, 2}));
    RenderConfig config;
    config.spp = 16;
    config.aovs = kAllAovs & ~kAovVariance;
    const View view{{0.5, -0.25, 2}, {0.5, -0.25, 0}, 60, 16, 12};
    const Image image = render_scene(b.scene, view, config).image;
    const RenderSpace space = render_space_of(b.scene, Workers(1));
    const PixelCamera camera = camera_of(view, b.scene, space);
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 16; ++x) {
            EXPECT_NEAR((*image.find("Z"))(x, y), 2, 1e-5);
            EXPECT_NEAR((*image.find("N.Z"))(x, y), 1, 1e-6);
            EXPECT_NEAR((*image.find("albedo.G"))(x, y), 0.5, 1e-6);
            EXPECT_EQ((*image.find_uint("id"))(x, y), 1u);
            EXPECT_NEAR((*image.find("motion.X"))(x, y), 0, 1e-5);
            const V3d p((*image.find("P.X"))(x, y), (*image.find("P.Y"))(x, y),
                        (*image.find("P.Z"))(x, y));
            const auto there = camera.project(p); // the mean of points in the pixel
            EXPECT_EQ(std::floor(there.x), x);
            EXPECT_EQ(std::floor(there.y), y);
            EXPECT_NEAR(p.z, 0, 1e-6);
        }
}

AnimationChannel moving(int node, const V3d& from, const V3d& to) {
    AnimationChannel channel;
    channel.node = node;
    channel.path = AnimationChannel::Path::translation;
    channel.times = {0, 1};
    channel.values = {std::array<double, 4>{from.x, from.y, from.z, 0},
                      std::array<double, 4>{to.x, to.y, to.z, 0}};
    return channel;
}

struct MovingScene {
    SceneBuilder builder;
    int block, eye;

    // A wall at z = 0, a block of 1 x 1 in front of it at z = 1, a camera at z = 5.
    MovingScene() {
        SceneBuilder& b = builder;
        const int material = b.add_material(lambert(V3f(0.5f)));
        b.add_quad({-9, -9, 0}, {18, 0, 0}, {0, 18, 0}, material);
        block = b.add_quad({-0.5f, -0.5f, 0}, {1, 0, 0}, {0, 1, 0}, material);
        b.scene.nodes[size_t(block)].matrix.reset();
        b.scene.nodes[size_t(block)].translation = {0, 0, 1};
        Camera camera;
        camera.yfov = 0.6;
        b.scene.cameras.push_back(camera);
        Node node;
        node.camera = 0;
        node.translation = {0, 0, 5};
        b.scene.nodes.push_back(node);
        eye = int(b.scene.nodes.size()) - 1;
    }

    Image frame(double time, double next_time) const {
        const Workers workers(1);
        Progress progress;
        const Scene& scene = builder.scene;
        const RenderSpace space = render_space_of(scene, workers);
        const PosedScene posed(scene, space, time, workers);
        const ChosenCamera chosen = choose_camera(scene, space, {});
        const PixelCamera now = pixel_camera(chosen, scene, space, time, kSize, kSize);
        const PixelCamera then = pixel_camera(chosen, scene, space, next_time, kSize, kSize);
        const NextFrame next{then, has_moving_surfaces_or_lights(scene)
                                       ? world_from_nodes(scene, next_time)
                                       : std::vector<M44d>()};
        RenderConfig config;
        config.spp = 4;
        config.aovs = kAovMotion | kAovId;
        config.path.sky = V3f(1);
        return render_frame(posed, now, fresh_seeds(0, 0, kSize, kSize), config, &next, workers,
                            progress)
            .image;
    }

    static constexpr int kSize = 32;
    // Pixels that one metre covers at a depth of one metre.
    const double focal_px = kSize / 2 / std::tan(0.3);
};

TEST(PathTracer, MotionFollowsAMovingCamera) {
    MovingScene scene;
    scene.builder.scene.animation = {moving(scene.eye, {0, 0, 5}, {1, -0.5, 5})};
    const Image image = scene.frame(0, 0.25); // the camera goes 0.25 m right and 0.125 m down
    int block = 0, wall = 0;
    for (int y = 0; y < MovingScene::kSize; ++y)
        for (int x = 0; x < MovingScene::kSize; ++x) {
            const bool centre = std::abs(x - 15.5) < 5 && std::abs(y - 15.5) < 5;
            const bool border = std::abs(x - 15.5) > 9 || std::abs(y - 15.5) > 9;
            if (!centre && !border) continue;
            const double depth = centre ? 4 : 5;
            ++(centre ? block : wall);
            EXPECT_NEAR((*image.find("motion.X"))(x, y), -0.25 / depth * scene.focal_px, 1e-4);
            EXPECT_NEAR((*image.find("motion.Y"))(x, y), -0.125 / depth * scene.focal_px, 1e-4);
        }
    EXPECT_GT(block, 50);
    EXPECT_GT(wall, 50);
}

TEST(PathTracer, MotionFollowsAMovingBlock) {
    MovingScene scene;
    scene.builder.scene.animation = {moving(scene.block, {0, 0, 1}, {0.4, 0.8, 1})};
    const Image image = scene.frame(0, 0.25);
    const auto &mx = *image.find("motion.X"), &my = *image.find("motion.Y");
    EXPECT_NEAR(mx(16, 16), 0.1 / 4 * scene.focal_px, 1e-4);
    EXPECT_NEAR(my(16, 16), -0.2 / 4 * scene.focal_px, 1e-4);
    EXPECT_NEAR(mx(2, 2), 0, 1e-5);
    EXPECT_NEAR(my(2, 2), 0, 1e-5);
    // Where motion points, the next frame shows the same surface.
    const Image later = scene.frame(0.25, 0.5);
    const auto &ids = *image.find_uint("id"), &later_ids = *later.find_uint("id");
    for (int y = 13; y < 19; ++y)
        for (int x = 13; x < 19; ++x)
            EXPECT_EQ(ids(x, y),
                      later_ids(int(x + 0.5 + double(mx(x, y))), int(y + 0.5 + double(my(x, y)))));
}

TEST(PathTracer, SamplesThatAreNotFiniteAreDroppedAndCounted) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0},
               b.add_material(emitter(V3f(std::numeric_limits<float>::quiet_NaN(), 1, 1))));
    RenderConfig config;
    config.spp = 4;
    const FrameResult result = render_scene(b.scene, {{0, 0, 3}, {0, 0, 0}, 20, 8, 8}, config);
    EXPECT_EQ(result.discarded_samples, 8u * 8u * 4u);
    EXPECT_EQ(mean_of(result.image, "G"), 0);
}

// Cameras, lights and surfaces in each other's way: nothing that is not finite comes out.
TEST(PathTracer, DegenerateScenesGiveFiniteImages) {
    SceneBuilder b;
    b.scene = cornell(glossy(V3f(0.3f), 0.6f, 1e6f), emitter(V3f(5)));
    const int bright = b.add_material(emitter(V3f(3)));
    b.add_triangle({0, 0, 0}, {0, 0, 0}, {1, 0, 0}, bright);                // no area
    b.add_triangle({0, 0, 0}, {1e-20f, 0, 0}, {0, 1e-20f, 0}, bright);      // almost none
    b.add_triangle({-1, 0, 0}, {1, 1e-7f, 0}, {1, 0, 0}, bright);           // a needle
    b.add_quad({-0.1f, 0.499f, -0.1f}, {0.2f, 0, 0}, {0, 0, 0.2f}, bright); // on the light
    b.place_light(point_light(V3d(1)), translated({0, -0.5, 0}));           // on the floor
    b.place_light(point_light(V3d(1)), translated({0, 0, 1.9}));            // in the camera
    RenderConfig config;
    config.spp = 16;
    config.aovs = kAllAovs;
    config.path.max_depth = 8;
    const View inside_ball = {{-0.2, -0.3, 0.05}, {0.2, 0.1, -0.3}, 90, 24, 24};
    for (const View& view : {cornell_view(24), inside_ball}) {
        const FrameResult result = render_scene(b.scene, view, config);
        EXPECT_EQ(result.discarded_samples, 0u);
        for (const Plane<float>& plane : result.image.planes)
            for (const float value : plane.pixels.values())
                ASSERT_TRUE(std::isfinite(value)) << plane.name;
        for (const char* channel : {"R", "G", "B"})
            for (const float value : result.image.find(channel)->values())
                ASSERT_GE(value, 0);
    }
}

TEST(PathTracer, KernelsFollowFromTheMaterials) {
    EXPECT_EQ(choose_kernel(cornell(lambert(V3f(1)), emitter(V3f(1)))).name, "diffuse");
    EXPECT_EQ(choose_kernel(cornell(metal(0.5f), emitter(V3f(1)))).name, "all lobes");
    EXPECT_EQ(choose_kernel(cornell(glass(1.5f), emitter(V3f(1)))).name, "all lobes");
}

// The same scene through a larger kernel gives the same image.
TEST(PathTracer, LargerKernelsGiveTheSameImage) {
    const Scene small = cornell(lambert(V3f(0.5f)), emitter(V3f(12)));
    Scene large = small;
    large.materials.push_back(glass(1.5f)); // on no surface
    RenderConfig config;
    config.spp = 16;
    const Image a = render_scene(small, cornell_view(24), config).image;
    const Image b = render_scene(large, cornell_view(24), config).image;
    for (size_t i = 0; i < a.find("R")->size(); ++i)
        EXPECT_NEAR((*a.find("R"))[i], (*b.find("R"))[i], 1e-4f * (1 + (*a.find("R"))[i]));
}

TEST(Film, AovNamesAreParsed) {
    EXPECT_EQ(parse_aovs("depth,normal"), uint32_t(kAovDepth | kAovNormal));
    EXPECT_EQ(parse_aovs("all"), kAllAovs);
    EXPECT_THROW(parse_aovs("depth,shine"), Error);
}

} // namespace
} // namespace ql
