#include "shading/light_emission.h"
#include "shading/lights.h"

#include "metrics/statistics.h"
#include "reference/scene_builder.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>

namespace ql {
namespace {

using namespace reference;

const Workers kOne(1);

World world_of(const Scene& scene) {
    return pose_world(scene, render_space_of(scene, kOne), 0, kOne);
}

std::optional<LightSample> sample(const LightSet& lights, const V3f& from, uint32_t i) {
    const PixelRandom random(9, i);
    const RandomWords w = random.words(0);
    return lights.sample(from, LightChoice::one, 0, unit_double(w[0], w[1]),
                         {unit_float(w[2]), unit_float(w[3])});
}

// Three triangles of different power and orientation, one with two sides.
SceneBuilder three_emitters() {
    SceneBuilder b;
    Material both = emitter(V3f(2));
    both.double_sided = true;
    const int one_side = b.add_material(emitter(V3f(1, 2, 6)));
    b.add_triangle({-1, 2, -1}, {1, 2, -1}, {0, 2, 1}, one_side); // normal down
    b.add_quad({-2, -1, -2}, {1, 1, 0}, {0, 0, 2}, b.add_material(both));
    return b;
}

TEST(Lights, DensitiesOfSamplesAreThoseAskedForLater) {
    const SceneBuilder b = three_emitters();
    const World world = world_of(b.scene);
    const EmbreeScene rays(world, nullptr, kOne);
    const LightSet lights(world);
    EXPECT_EQ(lights.triangle_count(), 3u);
    const V3f from(V3d(world.space.from_world({0.2, 0, 0.1})));
    int samples = 0;
    for (uint32_t i = 0; i < 2000; ++i) {
        const auto light = sample(lights, from, i);
        if (!light) continue;
        EXPECT_NEAR(light->direction.length(), 1, 1e-5f);
        Hit hit;
        ASSERT_TRUE(rays.intersect({from, 0, light->direction, kInfinity}, 0, hit));
        const Ray ray{from, 0, light->direction, kInfinity};
        const SurfacePoint at = geometric_point(world, ray, hit);
        EXPECT_NEAR(lights.pdf_solid_angle(at, light->direction, hit.t, LightChoice::one) /
                        light->pdf_solid_angle,
                    1, 1e-3);
        ++samples;
    }
    EXPECT_GT(samples, 1000);
}

// The mean of 1 / pdf over samples is the solid angle that the lights fill: by random directions.
TEST(Lights, SamplesFillTheSolidAngleOfTheEmitters) {
    const SceneBuilder b = three_emitters();
    const World world = world_of(b.scene);
    const EmbreeScene rays(world, nullptr, kOne);
    const LightSet lights(world);
    const V3f from(V3d(world.space.from_world({0.2, 0, 0.1})));
    constexpr uint32_t kSamples = 200'000;
    double by_lights = 0, by_directions = 0, expected = 0;
    for (uint32_t i = 0; i < kSamples; ++i) {
        if (const auto light = sample(lights, from, i))
            by_lights += double(light->weight.z) / kSamples;
        const RandomFloats u = PixelRandom(11, i).block(1);
        const V3f direction = square_to_uniform_sphere({u[0], u[1]});
        Hit hit;
        if (!rays.intersect({from, 0, direction, kInfinity}, 0, hit)) continue;
        const Ray ray{from, 0, direction, kInfinity};
        const SurfacePoint at = geometric_point(world, ray, hit);
        const Material& m = b.scene.materials[size_t(at.material)];
        if (at.ng.dot(direction) < 0 || m.double_sided)
            by_directions += double(m.emission.z) * double(lights.stored_from_real()) * 4 *
                             std::numbers::pi / kSamples;
    }
    expected = by_directions;
    EXPECT_NEAR(by_lights / expected, 1, 0.02);
}

// How often lights are picked, by x of the target.
std::map<float, uint64_t> picks_of(const LightSet& lights, uint32_t samples) {
    std::map<float, uint64_t> picks;
    for (uint32_t i = 0; i < samples; ++i)
        ++picks[sample(lights, V3f(0), i)->target.x];
    return picks;
}

std::vector<uint64_t> counts_of(const std::map<float, uint64_t>& picks) {
    std::vector<uint64_t> counts;
    for (const auto& pick : picks)
        counts.push_back(pick.second);
    return counts;
}

// A few lights are picked in proportion to what they send: then all samples weigh the same.
TEST(Lights, FewAreChosenByIrradiance) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
    std::vector<double> expected;
    double total = 0;
    for (const double power : {1.0, 5.0, 0.0, 14.0}) {
        b.place_light(point_light(V3d(power)), translated({power - 4, 0, 3}));
        const double irradiance = power / ((power - 4) * (power - 4) + 9);
        if (power > 0) expected.push_back(irradiance);
        total += irradiance;
    }
    constexpr uint32_t kSamples = 40'000;
    for (double& e : expected)
        e *= kSamples / total;
    const World world = world_of(b.scene);
    const LightSet lights(world);
    const auto picks = picks_of(lights, kSamples);
    ASSERT_EQ(picks.size(), 3u); // the dark one never
    EXPECT_GT(chi_square_test(counts_of(picks), expected).p_value, 0.001);
    for (uint32_t i = 0; i < 100; ++i)
        EXPECT_NEAR(std::ldexp(double(sample(lights, V3f(0), i)->weight.x), lights.exponent()) /
                        total,
                    1, 1e-4);
}

// Many are picked in proportion to their power, wherever they are.
TEST(Lights, ManyAreChosenByPower) {
    SceneBuilder b;
    b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
    std::vector<double> expected;
    constexpr int kLights = 40;
    constexpr uint32_t kSamples = 40'000;
    for (int i = 0; i < kLights; ++i) {
        b.place_light(point_light(V3d(1 + i % 3)), translated({i - 10.0, 0, 3}));
        expected.push_back(kSamples * double(1 + i % 3) / 79);
    }
    EXPECT_GT(chi_square_test(counts_of(picks_of(LightSet(world_of(b.scene)), kSamples)), expected)
                  .p_value,
              0.001);
}

// Lamps and emissive triangles together: the mean of the weights is the irradiance of all.
TEST(Lights, OfBothKindsAdd) {
    const auto irradiance = [](bool with_lamps, bool with_panel) {
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
        b.add_quad({-1, -1, 4}, {0, 2, 0}, {2, 0, 0},
                   b.add_material(with_panel ? emitter(V3f(1)) : lambert(V3f(1))));
        if (with_lamps)
            for (const double x : {-1.0, 2.0})
                b.place_light(point_light(V3d(1 + x * x)), translated({x, 0, 3}));
        const World world = world_of(b.scene);
        const LightSet lights(world);
        double sum = 0;
        constexpr uint32_t kSamples = 100'000;
        const V3f from(V3d(world.space.from_world({0.2, 0, 0})));
        for (uint32_t i = 0; i < kSamples; ++i)
            if (const auto light = sample(lights, from, i))
                sum += double(light->weight.x) * double(light->direction.z) / kSamples;
        return std::ldexp(sum, lights.exponent());
    };
    EXPECT_NEAR(irradiance(true, true) / (irradiance(true, false) + irradiance(false, true)), 1,
                0.01);
}

// Each lamp once, without chance, and the panel as if it were alone.
TEST(Lights, EachIsSampledWithCertainty) {
    const auto scene = [](bool with_lamps) {
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
        b.add_quad({-1, -1, 4}, {0, 2, 0}, {2, 0, 0}, b.add_material(emitter(V3f(8))));
        if (with_lamps)
            for (const double x : {-1.0, 2.0})
                b.place_light(point_light(V3d(1 + x * x)), translated({x, 0, 3}));
        return b.scene;
    };
    const Scene panel_alone = scene(false), together = scene(true);
    const World alone_world = world_of(panel_alone), world = world_of(together);
    const LightSet panel(alone_world), all(world);
    const V3f from(V3d(world.space.from_world({0, 0, 0})));
    ASSERT_EQ(all.sample_count(LightChoice::each), 3u);
    for (size_t i = 0; i < 2; ++i) {
        const double x = i == 0 ? -1 : 2;
        const auto lamp = all.sample(from, LightChoice::each, i, 0.3, {0.1f, 0.7f});
        ASSERT_TRUE(lamp);
        EXPECT_NEAR(std::ldexp(double(lamp->weight.x), all.exponent()), (1 + x * x) / (x * x + 9),
                    1e-4);
        EXPECT_EQ(lamp->pdf_solid_angle, 0);
    }
    const auto here = all.sample(from, LightChoice::each, 2, 0.8, {0.1f, 0.7f});
    const auto alone = panel.sample(from, LightChoice::one, 0, 0.8, {0.1f, 0.7f});
    ASSERT_TRUE(here && alone);
    EXPECT_NEAR(here->pdf_solid_angle / alone->pdf_solid_angle, 1, 1e-5);
    EXPECT_NEAR(std::ldexp(double(here->weight.x), all.exponent()) /
                    std::ldexp(double(alone->weight.x), panel.exponent()),
                1, 1e-5);
}

TEST(Lights, AreEachSampledOnlyWhereThereAreSeveralButFew) {
    const auto choice = [](int lamps, bool wanted) {
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
        for (int i = 0; i < lamps; ++i)
            b.place_light(point_light(V3d(1)), translated({double(i), 0, 3}));
        return LightSet(world_of(b.scene)).choice(wanted);
    };
    EXPECT_EQ(choice(1, true), LightChoice::one);
    EXPECT_EQ(choice(2, true), LightChoice::each);
    EXPECT_EQ(choice(2, false), LightChoice::one);
    EXPECT_EQ(choice(32, true), LightChoice::each);
    EXPECT_EQ(choice(33, true), LightChoice::one);
}

TEST(Lights, SidesThatDoNotShineAreNotSampled) {
    SceneBuilder b;
    b.add_triangle({-1, 2, -1}, {1, 2, -1}, {0, 2, 1}, b.add_material(emitter(V3f(1))));
    b.add_quad({-1, -1, -1}, {1, 0, 0}, {0, 0, 1}, b.add_material(lambert(V3f(1))));
    const World world = world_of(b.scene);
    const LightSet lights(world);
    const V3f below(V3d(world.space.from_world({0, 0, 0})));
    const V3f above(V3d(world.space.from_world({0, 4, 0})));
    for (uint32_t i = 0; i < 100; ++i) {
        EXPECT_TRUE(sample(lights, below, i));
        EXPECT_FALSE(sample(lights, above, i));
    }
}

// A lamp of 8 x 8 texels in a black texture of 64 x 64, wherever it lies.
TEST(Lights, SmallPartsOfATextureShine) {
    for (int at = 0; at < 56; at += 3) {
        SceneBuilder b;
        Material m = emitter(V3f(5));
        m.emission_texture.texture = 0;
        Texture texture{"", 64, 64, std::vector<uint8_t>(64 * 64 * 4, 0)};
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 8; ++x)
                for (int c = 0; c < 4; ++c)
                    texture.texels[size_t(4 * (64 * (at + y) + 55 - at + x) + c)] = 255;
        b.scene.textures.push_back(texture);
        b.add_quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, b.add_material(m));
        b.scene.meshes.back().uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        const World world = world_of(b.scene);
        const LightSet lights(world);
        EXPECT_FALSE(lights.empty()) << at;
        EXPECT_GT(LightEmission(lights).power(), 0) << at;
    }
}

TEST(Lights, TrianglesOfABlackTextureAreNeverChosen) {
    SceneBuilder b;
    Material m = emitter(V3f(5));
    m.emission_texture.texture = 0;
    Texture texture{"", 64, 64, std::vector<uint8_t>(64 * 64 * 4, 0)};
    texture.texels[4 * (64 * 60 + 60)] = 255;
    b.scene.textures.push_back(texture);
    b.add_quad({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, b.add_material(m));
    b.scene.meshes.back().uvs[0] = {{0.1f, 0.1f}, {0.5f, 0.1f}, {0.5f, 0.5f}, {0.1f, 0.5f}};
    EXPECT_TRUE(LightSet(world_of(b.scene)).empty());
}

TEST(Lights, BrightnessIsKeptNearOneWhateverItsUnit) {
    for (const double intensity : {1e-45, 1e-30, 1.0, 1e30, 1e45}) {
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(1))));
        b.place_light(point_light(V3d(intensity)), translated({0, 0, 2}));
        const LightSet lights(world_of(b.scene));
        EXPECT_TRUE(std::isnormal(lights.stored_from_real())) << intensity;
        const auto light = sample(lights, V3f(0), 0);
        ASSERT_TRUE(light);
        EXPECT_TRUE(std::isfinite(light->weight.x) && light->weight.x > 0) << intensity;
    }
}

} // namespace
} // namespace ql
