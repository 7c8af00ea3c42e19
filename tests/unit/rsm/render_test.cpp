#include "rsm/render.h"

#include "statistics/rsm_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace ql {
namespace {

using namespace rsm_test;

constexpr V3d kFrom{0.9, 0.8, 0.9}, kAt{-0.3, -0.5, -0.3};

void expect_finite(const Image& image) {
    for (const Plane<float>& plane : image.planes)
        for (const float v : plane.pixels.values())
            ASSERT_TRUE(std::isfinite(v) && v >= 0) << plane.name;
}

std::vector<RsmConfig> every_gather(int map_size) {
    std::vector<RsmConfig> configs;
    for (const Gather gather : {Gather::pattern, Gather::full, Gather::importance})
        for (const DirectMode direct : {DirectMode::ray, DirectMode::map}) {
            configs.push_back(config_of(gather, map_size, 16));
            configs.back().direct = direct;
            if (gather == Gather::importance) {
                configs.back().compensate = Compensate::yes;
                configs.back().map.point = TexelPoint::jittered;
            }
        }
    RsmConfig thesis = config_of(Gather::pattern, map_size, 16);
    thesis.gather.weights = PatternWeights::thesis;
    thesis.gather.mips = MipUse::on;
    thesis.gather.bound = {0, 0.25f};
    thesis.map.measure = FluxMeasure::intensity;
    configs.push_back(thesis);
    return configs;
}

// The bright floor outside shines through the walls of a closed dark box that holds the camera.
Stage closed_box_beside_a_lit_floor() {
    Builder b;
    const int white = b.material(V3f(0.8f));
    b.quad({-4, -1, -4}, {0, 0, 8}, {8, 0, 0}, white);
    b.box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}, white);
    b.light(Light::Kind::spot, {2, 2, 2}, {0, -1, 0}, 50).outer_angle = 45 * kDegree;
    return Stage(b, 12, {0.3, 0.2, 0.3}, {-0.4, 0.1, -0.3});
}

TEST(RsmRender, WithoutTheShadowTestLightPassesThroughWallsAndWithItNoneDoes) {
    const Stage stage = closed_box_beside_a_lit_floor();
    for (RsmConfig config : every_gather(32)) {
        config.gather.radius = 2;
        EXPECT_EQ(mean_of(stage.render(config, 2), "indirect."), 0);
        config.compensate = Compensate::no;
        config.gather.shadow_test = ShadowTest::off;
        EXPECT_GT(mean_of(stage.render(config, 2), "indirect."), 1e-4);
    }
}

TEST(RsmRender, TheUnitOfLengthDoesNotMatter) {
    const Stage metres(spot_room(), 12, kFrom, kAt);
    for (const RsmConfig& base : every_gather(16)) {
        if (base.gather.weights == PatternWeights::thesis) continue;
        const Image expected = metres.render(base, 2);
        for (const double unit : {1e-4, 0.37, 1e4}) {
            const Image image = Stage(spot_room(unit), 12, kFrom, kAt).render(base, 2);
            double difference = 0, sum = 0;
            for (const char* c : {"R", "G", "B"})
                for (size_t i = 0; i < 144; ++i) {
                    const double a = double((*image.find(c))[i]);
                    const double b = double((*expected.find(c))[i]);
                    difference += std::abs(a - b);
                    sum += b;
                }
            EXPECT_LT(difference / sum, 1e-3) << unit;
        }
    }
}

TEST(RsmRender, LightScalesExactlyWithPowersOfTwo) {
    const auto lit = [&](double factor) {
        Builder b = spot_room();
        b.scene.lights[0].intensity *= factor;
        return Stage(b, 8, kFrom, kAt).render(config_of(Gather::importance, 16), 2);
    };
    const Image one = lit(1);
    for (const int power : {-80, 3, 80}) {
        const Image image = lit(std::ldexp(1.0, power));
        for (size_t i = 0; i < 64; ++i)
            EXPECT_EQ((*image.find("G"))[i], std::ldexp((*one.find("G"))[i], power));
    }
}

TEST(RsmRender, LightsAddUp) {
    Builder first = spot_room(), second = spot_room(), both = spot_room();
    second.scene.nodes.pop_back();
    second.scene.lights.clear();
    for (Builder* b : {&second, &both})
        b->light(Light::Kind::directional, {0, 0, 0}, {0.2, -1, 0.1}, 1);
    for (Builder* b : {&second, &both})
        b->light(Light::Kind::point, {0.4, 0.4, 0.4}, {0, 0, -1}, 0.5);
    const RsmConfig config = config_of(Gather::full, 16);
    const auto indirect = [&](const Builder& b) {
        return Stage(b, 8, kFrom, kAt).render(config, 1);
    };
    const Image a = indirect(first), b = indirect(second), sum = indirect(both);
    for (size_t i = 0; i < 64; ++i)
        for (const char* name : {"indirect.R", "direct.G"})
            EXPECT_NEAR((*sum.find(name))[i], (*a.find(name))[i] + (*b.find(name))[i],
                        1e-5 * ((*sum.find(name))[i] + 1e-3));
}

TEST(RsmRender, TheNumberOfThreadsChangesNoBit) {
    const Stage stage(spot_room(), 40, kFrom, kAt);
    const Workers one(1), three(3);
    for (RsmConfig config : every_gather(12))
        for (const int interpolate : {1, 3}) {
            config.interpolate = interpolate;
            config.aovs = kFirstHitAovs & ~uint32_t(kAovMotion);
            const Image a = stage.render(config, 2, nullptr, one);
            const Image b = stage.render(config, 2, nullptr, three);
            ASSERT_EQ(a.planes.size(), b.planes.size());
            for (size_t i = 0; i < a.planes.size(); ++i)
                EXPECT_EQ(a.planes[i].pixels, b.planes[i].pixels) << a.planes[i].name;
        }
}

TEST(RsmRender, DirectLightByRayIsThatOfThePathTracer) {
    const Stage stage(spot_room(), 24, kFrom, kAt);
    EXPECT_NEAR(mean_of(stage.render(config_of(Gather::importance, 4, 1), 256), "direct.") /
                    mean_of(stage.reference(256), "direct."),
                1, 0.01);
}

TEST(RsmRender, DirectLightByMapNearsThatByRay) {
    Builder b = spot_room();
    b.light(Light::Kind::point, {0.5, 0.6, 0.1}, {0, 0, -1}, 1);
    b.light(Light::Kind::directional, {0, 0, 0}, {0.2, -1, 0.1}, 1);
    const Stage stage(b, 32, kFrom, kAt);
    for (const MapKind kind : {MapKind::equal_area, MapKind::perspective}) {
        RsmConfig config = config_of(Gather::importance, 256, 1);
        config.map.kind = kind;
        config.pixel = PixelPoint::centre;
        const Image by_ray = stage.render(config, 1);
        config.direct = DirectMode::map;
        const Image by_map = stage.render(config, 1);
        double difference = 0, sum = 0;
        for (size_t i = 0; i < 32 * 32; ++i) {
            const double r = double((*by_ray.find("direct.G"))[i]);
            difference += std::abs(double((*by_map.find("direct.G"))[i]) - r);
            sum += r;
        }
        EXPECT_LT(difference / sum, 0.04);
    }
}

TEST(RsmRender, InterpolationSavesGathersAndChangesLittle) {
    const Stage stage(spot_room(), 48, kFrom, kAt);
    RsmConfig config = config_of(Gather::full, 12);
    config.pixel = PixelPoint::centre;
    RsmCounts every, some;
    const Image exact = stage.render(config, 1, &every);
    config.interpolate = 4;
    const Image image = stage.render(config, 1, &some);
    EXPECT_EQ(every.interpolated_pixels, 0u);
    EXPECT_GT(some.interpolated_pixels, some.lit_pixels / 2);
    EXPECT_LT(some.gather_shadow, every.gather_shadow / 2);
    double difference = 0, sum = 0;
    for (size_t i = 0; i < 48 * 48; ++i) {
        difference +=
            std::abs(double((*image.find("indirect.G"))[i] - (*exact.find("indirect.G"))[i]));
        sum += double((*exact.find("indirect.G"))[i]);
    }
    EXPECT_LT(difference / sum, 0.05);
}

TEST(RsmRender, OnlyTheDiffusePartOfAReceiverIsLitByTheMap) {
    Builder plain = spot_room(), glossy = spot_room(), mirror = spot_room();
    for (Material& m : glossy.scene.materials) {
        m.ks = 0.3f;
        m.exponent = 20;
    }
    for (Material& m : mirror.scene.materials) {
        m.kd = 0;
        m.kr = 1;
    }
    const RsmConfig config = config_of(Gather::importance, 16);
    const Image a = Stage(plain, 8, kFrom, kAt).render(config, 2);
    const Image b = Stage(glossy, 8, kFrom, kAt).render(config, 2);
    EXPECT_EQ(*a.find("indirect.G"), *b.find("indirect.G"));
    EXPECT_GT(mean_of(b, "direct."), mean_of(a, "direct."));
    EXPECT_EQ(mean_of(Stage(mirror, 8, kFrom, kAt).render(config, 2), "indirect."), 0);
}

TEST(RsmRender, TexturesAndCoatsDimWhatTheMapSends) {
    Builder textured = spot_room(), coated = spot_room();
    for (Mesh& mesh : textured.scene.meshes)
        mesh.uvs[0].assign(mesh.positions.size(), V2f(0.5f, 0.5f));
    textured.scene.textures.push_back({"grey", 1, 1, {128, 128, 128, 255}});
    for (Material& m : textured.scene.materials)
        m.base_color_texture.texture = 0;
    for (Material& m : coated.scene.materials) {
        m.model = MaterialModel::metallic_roughness;
        m.metallic = 0;
        m.roughness = 0.5f;
    }
    const RsmConfig config = config_of(Gather::importance, 16);
    const double plain = mean_of(Stage(spot_room(), 8, kFrom, kAt).render(config, 4), "indirect.");
    // Twice the factor 128/255: at the texel and at the receiver.
    EXPECT_NEAR(mean_of(Stage(textured, 8, kFrom, kAt).render(config, 4), "indirect.") / plain,
                std::pow(128.0 / 255, 2), 1e-3);
    const double share =
        mean_of(Stage(coated, 8, kFrom, kAt).render(config, 4), "indirect.") / plain;
    EXPECT_GT(share, 0.8);
    EXPECT_LT(share, 0.95);
}

TEST(RsmRender, CornersStayBounded) {
    // Without a bound the brightest pixel of a corner grows with the samples.
    const Stage stage(spot_room(), 24, {-0.7, -0.7, -0.7}, {-1, -1, -1}, 40);
    const auto brightest = [&](const RsmConfig& config) {
        const Image image = stage.render(config, 1);
        const std::vector<float>& values = image.find("indirect.G")->values();
        return *std::max_element(values.begin(), values.end());
    };
    for (const int size : {4, 16, 64})
        EXPECT_LT(brightest(config_of(Gather::importance, size, 256)), 0.3f) << size;
    RsmConfig unbounded = config_of(Gather::importance, 64, 256);
    unbounded.gather.bound = {0, 0};
    EXPECT_GT(brightest(unbounded), 0.5f);
}

TEST(RsmRender, ExtremesGiveFiniteImages) {
    struct Case {
        const char* name;
        std::function<void(Builder&)> change;
        bool is_dark;
    };
    const auto replace_light = [](Builder& b, Light::Kind kind, const V3d& at, const V3d& to) {
        b.scene.nodes.pop_back();
        b.scene.lights.clear();
        b.light(kind, at, to, 5).outer_angle = 60 * kDegree;
    };
    const std::vector<Case> cases = {
        {"no light",
         [](Builder& b) {
             b.scene.nodes.pop_back();
             b.scene.lights.clear();
         },
         true},
        {"light behind the wall, seeing nothing",
         [&](Builder& b) {
             replace_light(b, Light::Kind::spot, {-1.5, 0, 0}, {-1, 0, 0});
         },
         true},
        {"light inside a block",
         [&](Builder& b) {
             replace_light(b, Light::Kind::point, {0.5, -0.5, 0}, {1, 0, 0});
             b.box({0.4, -0.6, -0.2}, {0.6, -0.4, 0.2}, 0);
         },
         true},
        {"light in the plane of a wall",
         [&](Builder& b) {
             replace_light(b, Light::Kind::point, {-1, 0, 0}, {1, 0, 0});
         },
         false},
        {"light in a corner",
         [&](Builder& b) {
             replace_light(b, Light::Kind::spot, {-1, -1, -1}, {1, 1, 1});
         },
         false},
        {"light at the camera",
         [&](Builder& b) { replace_light(b, Light::Kind::point, kFrom, kAt); }, false},
        {"cut-off 90 degrees", [](Builder& b) { b.scene.lights[0].outer_angle = 90 * kDegree; },
         false},
        {"cut-off 0", [](Builder& b) { b.scene.lights[0].outer_angle = 0; }, true},
        {"exponent 1e6", [](Builder& b) { b.scene.lights[0].exponent = 1e6; }, false},
        {"black walls",
         [](Builder& b) {
             for (Material& m : b.scene.materials)
                 m.base_color = V3f(0);
         },
         true},
    };
    for (const Case& c : cases) {
        Builder b = spot_room();
        c.change(b);
        const Stage stage(b, 6, kFrom, kAt);
        for (const int size : {1, 9})
            for (const RsmConfig& config : every_gather(size)) {
                SCOPED_TRACE(c.name);
                const Image image = stage.render(config, 2);
                expect_finite(image);
                const double indirect = mean_of(image, "indirect.");
                EXPECT_TRUE(indirect == 0 || !c.is_dark) << indirect;
            }
    }
}

TEST(RsmRender, MeasuringTheRaysLeavesTheImageAsItIs) {
    const Stage stage(spot_room(), 12, kFrom, kAt);
    for (RsmConfig config : every_gather(8)) {
        const Image plain = stage.render(config, 1);
        config.measure = RayMeasure::on;
        RsmCounts counts;
        const Image measured = stage.render(config, 1, &counts);
        EXPECT_EQ(*plain.find("indirect.G"), *measured.find("indirect.G"));
        EXPECT_GT(counts.gather_ns, 0u);
        EXPECT_GT(counts.bare_ns, 0u);
    }
}

TEST(RsmRender, ACameraThatSeesNothingGivesBlack) {
    Builder b;
    b.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, b.material(V3f(0.5f)));
    b.light(Light::Kind::point, {0, 1, 0}, {0, 0, -1}, 1);
    const Stage stage(b, 4, {0, 1, 0}, {0, 5, 0.1});
    for (const RsmConfig& config : every_gather(4))
        EXPECT_EQ(mean_of(stage.render(config, 1), ""), 0);
}

TEST(RsmRender, TheWeightsOfTheThesisDependOnTheUnitOfLength) {
    // Its divisor is at least one square metre whatever the scene's size.
    const auto mean = [](double unit) {
        const Stage stage(spot_room(unit), 8, kFrom, kAt);
        RsmConfig config = every_gather(16).back();
        config.gather.bound.least_distance2 = float(std::pow(stage.posed().world().space.scale, 2));
        return mean_of(stage.render(config, 1), "indirect.");
    };
    EXPECT_LT(mean(0.1), 0.1 * mean(1));
}

// Texels of equal area are slivers opposite of where a point light's map begins.
TEST(RsmRender, DirectLightByMapLeavesNoShadowsOnEmptyWalls) {
    Builder room;
    room.box({-1, -1, -1}, {1, 1, 1}, room.material({0.7f, 0.7f, 0.7f}));
    room.light(Light::Kind::point, {0, 0, 0}, {0, 0, -1}, 1);
    for (const double z : {-1.0, 1.0}) {
        const Stage stage(room, 24, {0.01, 0.02, 0}, {0.01, 0.02, z});
        RsmConfig config = config_of(Gather::importance, 256, 1);
        config.pixel = PixelPoint::centre;
        const double by_ray = mean_of(stage.render(config, 1), "direct.");
        config.direct = DirectMode::map;
        EXPECT_NEAR(mean_of(stage.render(config, 1), "direct.") / by_ray, 1, 0.01) << z;
    }
}

TEST(RsmRender, SeedsOfOneFrameAreNotThoseOfAnother) {
    const Stage stage(spot_room(), 8, kFrom, kAt);
    const auto values = [&](uint64_t seed, uint32_t frame) {
        RsmConfig config = config_of(Gather::importance, 64, 8);
        config.rotation = Rotation::white;
        config.seed = seed;
        config.frame = frame;
        return stage.render(config, 1).find("indirect.G")->values();
    };
    EXPECT_NE(values(0, 0), values(0, 1));
    EXPECT_NE(values(0, 0), values(1, 0));
    EXPECT_NE(values(0, 1), values(1, 0));
}

} // namespace
} // namespace ql
