#include "rsm/map.h"

#include "reference/rsm_reference.h"
#include "rsm/map_image.h"
#include "statistics/rsm_scenes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

using namespace rsm_test;

constexpr double kPiD = std::numbers::pi;

// Red flux of all maps in watts.
double flux_watts(const Stage& stage, const MapConfig& config) {
    double sum = 0;
    for (const Image& image :
         map_images(stage.maps(config), stage.posed().world(), stage.posed().lights().exponent(),
                    config.measure, MipUse::off))
        for (const float v : image.find("flux.R")->values())
            sum += double(v);
    return sum;
}

Stage lit_box(Light::Kind kind, double unit = 1, double degrees = 60) {
    Builder b;
    b.unit = unit;
    b.box({-1, -1, -1}, {1, 1, 1}, b.material({0.5f, 0.25f, 0}));
    Light& light = b.light(kind, {0.2, 0.1, -0.3}, {1, -2, 0.5}, 7);
    light.outer_angle = degrees * kDegree;
    light.exponent = 2;
    return Stage(b, 4, {0, 0, 0.9}, {0, 0, 0});
}

TEST(RsmMap, APointLightInAClosedBoxReflectsAlbedoTimesItsPower) {
    for (const double unit : {1e-3, 1.0, 1e3}) {
        const Stage stage = lit_box(Light::Kind::point, unit);
        EXPECT_NEAR(flux_watts(stage, {.size = 32}) / (0.5 * 4 * kPiD * 7 * unit * unit), 1, 1e-4);
        EXPECT_NEAR(flux_watts(stage, {.size = 32, .kind = MapKind::perspective}) /
                        (0.5 * 4 * kPiD * 7 * unit * unit),
                    1, 1e-3);
    }
}

TEST(RsmMap, ASpotLightInAClosedBoxReflectsAlbedoTimesItsPower) {
    // The integral of cos^2 over the cone: 2 pi (1 - cos^3) / 3.
    const double power = 7 * 2 * kPiD * (1 - std::pow(0.5, 3)) / 3;
    const Stage stage = lit_box(Light::Kind::spot);
    EXPECT_NEAR(flux_watts(stage, {.size = 128}) / (0.5 * power), 1, 1e-3);
    EXPECT_NEAR(flux_watts(stage, {.size = 256, .kind = MapKind::perspective}) / (0.5 * power), 1,
                0.01);
}

TEST(RsmMap, AConeOf90DegreesIsAHalfSpace) {
    const Stage stage = lit_box(Light::Kind::spot, 1, 90);
    EXPECT_NEAR(flux_watts(stage, {.size = 64}) / (0.5 * 7 * 2 * kPiD / 3), 1, 1e-2);
}

TEST(RsmMap, ALightWithoutIntensityOrConeGetsNoMap) {
    Builder b = spot_room();
    b.light(Light::Kind::point, {0, 0, 0}, {0, 0, -1}, 0);
    b.light(Light::Kind::spot, {0, 0, 0}, {0, 0, -1}, 1).outer_angle = 0;
    const Stage stage(b, 4, {0.9, 0.8, 0.9}, {0, 0, 0});
    EXPECT_EQ(stage.maps({.size = 4}).size(), 1u);
}

TEST(RsmMap, LayersAreInTheUnitsOfTheScene) {
    for (const double unit : {0.01, 1.0, 100.0}) {
        const Stage stage = lit_box(Light::Kind::point, unit);
        const auto images =
            map_images(stage.maps({.size = 8}), stage.posed().world(),
                       stage.posed().lights().exponent(), FluxMeasure::watts, MipUse::off);
        ASSERT_EQ(images.size(), 1u);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x) {
                const auto at = [&](const char* name) {
                    return double((*images[0].find(name))(x, y));
                };
                // On one of the walls, its normal inwards, as far from the light as Z says.
                const V3d p = V3d(at("P.X"), at("P.Y"), at("P.Z")) / unit;
                const V3d n(at("N.X"), at("N.Y"), at("N.Z"));
                EXPECT_NEAR(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1, 1e-5);
                EXPECT_NEAR(p.dot(n), -1, 1e-5);
                EXPECT_NEAR(at("Z") / unit, (p - V3d(0.2, 0.1, -0.3)).length(), 1e-5);
            }
    }
}

TEST(RsmMap, TexelsThatSeeNothingAreZeroInFiles) {
    Builder b;
    b.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, b.material(V3f(0.5f)));
    b.light(Light::Kind::point, {0, 1, 0}, {0, 0, -1}, 1);
    const Stage stage(b, 4, {0, 1, 2}, {0, 0, 0});
    const auto images =
        map_images(stage.maps({.size = 8}), stage.posed().world(),
                   stage.posed().lights().exponent(), FluxMeasure::watts, MipUse::on);
    EXPECT_EQ(images.size(), 4u); // 8, 4, 2, 1
    const Array2D<float>& depth = *images[0].find("Z");
    size_t empty = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
        empty += depth[i] == 0;
        for (const Plane<float>& plane : images[0].planes) {
            EXPECT_TRUE(std::isfinite(plane.pixels[i])) << plane.name;
            if (depth[i] == 0) {
                EXPECT_EQ(plane.pixels[i], 0) << plane.name;
            }
        }
    }
    EXPECT_GT(empty, depth.size() / 4);
    EXPECT_LT(empty, depth.size());
}

TEST(RsmMap, JitteredTexelsChangeWithThePassAndCentredOnesDoNot) {
    const Stage stage = lit_box(Light::Kind::point);
    const auto px = [&](TexelPoint point, uint32_t pass) {
        return stage.maps({.size = 4, .point = point, .pass = pass})[0].texels.px;
    };
    EXPECT_EQ(px(TexelPoint::centre, 0), px(TexelPoint::centre, 1));
    EXPECT_NE(px(TexelPoint::jittered, 0), px(TexelPoint::jittered, 1));
}

TEST(RsmMipChain, EveryLevelOfAnySizeKeepsTheMeanFlux) {
    const Stage stage(spot_room(), 4, {0.9, 0.8, 0.9}, {0, 0, 0});
    for (const int size : {1, 2, 7, 16, 27}) {
        const auto maps = stage.maps({.size = size});
        const MipChain mips(maps[0]);
        EXPECT_EQ(mips.size(mips.levels() - 1), 1);
        const double mean = maps[0].flux.x / (size * size);
        for (int level = 0; level < mips.levels(); ++level) {
            double sum = 0;
            for (const float v : mips.texels(level).red)
                sum += double(v);
            EXPECT_NEAR(sum / double(mips.texels(level).count()), mean, 1e-5 * mean);
        }
    }
}

TEST(RsmMipChain, PositionsInALevelLieBetweenThoseTheyAverage) {
    const Stage stage(spot_room(), 4, {0.9, 0.8, 0.9}, {0, 0, 0});
    const auto maps = stage.maps({.size = 8});
    const MipChain mips(maps[0]);
    const Texels &fine = mips.texels(0), &coarse = mips.texels(1);
    for (size_t y = 0; y < 4; ++y)
        for (size_t x = 0; x < 4; ++x) {
            float sum = 0;
            for (const size_t i :
                 {16 * y + 2 * x, 16 * y + 2 * x + 1, 16 * y + 2 * x + 8, 16 * y + 2 * x + 9})
                sum += fine.py[i] / 4;
            EXPECT_NEAR(coarse.py[4 * y + x], sum, 1e-6);
        }
}

TEST(RsmGather, OneWallAndOneTexelGiveTheClosedForm) {
    // A narrow spot meets a wall head on at distance 2; the receiver looks back from the side.
    for (const double unit : {1e-4, 1.0, 1e4}) {
        Builder b;
        b.unit = unit;
        b.quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, b.material({0.8f, 0.4f, 0.2f}));
        Light& light = b.light(Light::Kind::spot, {0, 0, 2}, {0, 0, -1}, 5);
        light.outer_angle = 0.01;
        light.exponent = 0;
        const Stage stage(b, 4, {0, 0, 5}, {0, 0, 0});
        const auto maps = stage.maps({.size = 1});
        const double scale = stage.posed().world().space.scale;
        const auto at = [&](const V3d& p) {
            return V3f(stage.posed().world().space.from_world(p * unit));
        };
        const V3f n = V3f(-1, 0, -0.5f).normalized();
        const Receiver receiver{at({1, 0, 1.5}), n, n, 0};
        ShadowLog log;
        const double solid_angle = 4 * kPiD * std::pow(std::sin(0.005), 2);
        const double flux = 5 * solid_angle * 0.8, area = solid_angle * 4;
        const double d2 = 1 + 1.5 * 1.5, d = std::sqrt(d2);
        const double cosines = (1.5 / d) * ((1 + 0.75) / std::sqrt(1.25) / d);
        for (const bool disc : {true, false}) {
            GatherConfig config{.gather = Gather::full};
            config.bound.radius2_scale = disc ? 1.0f : 0.0f;
            const Gatherer gatherer(stage.posed().rays(), maps, config);
            const double expected = flux / kPiD * cosines / (d2 + (disc ? area / kPiD : 0));
            const double real = std::ldexp(1.0, stage.posed().lights().exponent());
            EXPECT_NEAR(double(gatherer.irradiance(receiver, {}, {}, 0, log).x) * real / expected,
                        1, 1e-5)
                << unit << " " << scale;
        }
    }
}

TEST(RsmGather, FullEqualsItsSlowTwin) {
    const Stage stage(spot_room(), 8, {0.9, 0.8, 0.9}, {-0.3, -0.5, -0.3});
    // A size that leaves a part of a block over.
    const auto maps = stage.maps({.size = 13});
    for (const ShadowTest test : {ShadowTest::on, ShadowTest::off})
        for (const GeometryBound bound : {GeometryBound{}, GeometryBound{0, 0.01f}}) {
            const Gatherer gatherer(stage.posed().rays(), maps,
                                    {.gather = Gather::full, .shadow_test = test, .bound = bound});
            for (const Receiver& r : stage.receivers()) {
                ShadowLog log;
                const V3f fast = gatherer.irradiance(r, {}, {}, 0, log);
                const V3d slow =
                    full_irradiance_reference(stage.posed().rays(), maps, r, test, bound);
                EXPECT_NEAR(fast.x, slow.x, 1e-5 * (slow.x + 1e-3));
                EXPECT_NEAR(fast.y, slow.y, 1e-5 * (slow.y + 1e-3));
            }
        }
}

TEST(RsmGather, TheShadowTestCostsOneRayForEachFacingLitTexel) {
    const Stage stage(spot_room(), 4, {0.9, 0.8, 0.9}, {-0.3, -0.5, -0.3});
    const auto maps = stage.maps({.size = 8});
    const Gatherer gatherer(stage.posed().rays(), maps, {.gather = Gather::full});
    for (const Receiver& r : stage.receivers()) {
        uint64_t facing = 0;
        for (size_t i = 0; i < maps[0].texels.count(); ++i)
            facing += maps[0].texels.flux(i) != V3f(0, 0, 0) &&
                              bounded_geometry(r, maps[0].texels.position(i),
                                               maps[0].texels.normal(i), 0, {}) > 0
                          ? 1u
                          : 0u;
        ShadowLog log;
        std::vector<Ray> rays;
        log.rays = &rays;
        gatherer.irradiance(r, {}, {}, 0, log);
        EXPECT_EQ(log.count, facing);
        EXPECT_EQ(rays.size(), facing);
    }
}

} // namespace
} // namespace ql
