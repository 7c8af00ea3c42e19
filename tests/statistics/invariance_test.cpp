// What must not change the image: the unit of length, where the scene lies, the unit of light.
#include "reference/scene_builder.h"

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

RenderConfig config() {
    RenderConfig c;
    c.spp = 4;
    return c;
}

// Everything s times as long; candela times s^2, nits as they are.
FrameResult render_scaled(double s, double light = 1) {
    Scene scene = lit_box();
    for (Node& node : scene.nodes)
        node.matrix = *node.matrix * scaled(V3d(s));
    for (Light& l : scene.lights)
        l.intensity *= s * s * light;
    for (Material& m : scene.materials)
        m.emission *= float(light);
    View view = cornell_view(32);
    view.from *= s;
    return render_scene(scene, view, config());
}

FrameResult render_shifted(const V3d& by) {
    Scene scene = lit_box();
    for (Node& node : scene.nodes)
        node.matrix = *node.matrix * translated(by);
    View view = cornell_view(32);
    view.from += by;
    view.at += by;
    return render_scene(scene, view, config());
}

bool same_bytes(const Image& a, const Image& b) {
    for (const Plane<float>& plane : a.planes)
        if (!(plane.pixels == *b.find(plane.name))) return false;
    return true;
}

// Rounding sends a few paths another way; nearly all pixels stay where they are.
void expect_same_but_for_rounding(const Image& a, const Image& b, double tolerance,
                                  double largest_share) {
    size_t different = 0, samples = 0;
    for (const Plane<float>& plane : a.planes)
        for (size_t i = 0; i < plane.pixels.size(); ++i, ++samples) {
            const double x = double(plane.pixels[i]), y = double((*b.find(plane.name))[i]);
            if (!(std::abs(x - y) <= tolerance * (std::abs(x) + 0.01))) ++different;
        }
    EXPECT_LE(double(different), largest_share * double(samples));
}

TEST(Invariance, PowersOfTwoOfTheUnitOfLengthChangeNoBit) {
    const FrameResult metres = render_scaled(1);
    ASSERT_GT(mean_of(metres.image, "R"), 0.05);
    for (const int exponent : {-20, -1, 3, 20})
        EXPECT_TRUE(same_bytes(metres.image, render_scaled(std::ldexp(1.0, exponent)).image))
            << "2^" << exponent;
}

TEST(Invariance, TheUnitOfLengthChangesRoundingAlone) {
    const FrameResult metres = render_scaled(1);
    for (const double s : {1e-6, 1e-3, 1e3, 1e6}) {
        SCOPED_TRACE(s);
        expect_same_but_for_rounding(metres.image, render_scaled(s).image, 1e-4, 0.01);
    }
}

TEST(Invariance, ThePlaceOfTheSceneChangesRoundingAlone) {
    const FrameResult here = render_shifted(V3d(0));
    expect_same_but_for_rounding(here.image, render_shifted({1e4, -2e4, 1.5e4}).image, 1e-4, 0.01);
    expect_same_but_for_rounding(here.image, render_shifted({1e6, 3e6, -1e6}).image, 1e-4, 0.01);
}

TEST(Invariance, LightScalesExactlyByPowersOfTwo) {
    const FrameResult one = render_scaled(1);
    for (const int exponent : {-99, -3, 1, 99, 112}) {
        const FrameResult other = render_scaled(1, std::ldexp(1.0, exponent));
        for (const Plane<float>& plane : one.image.planes)
            for (size_t i = 0; i < plane.pixels.size(); ++i)
                ASSERT_EQ(std::ldexp(plane.pixels[i], exponent), (*other.image.find(plane.name))[i])
                    << "2^" << exponent;
    }
}

TEST(Invariance, DimLightInLargeScenesAndBrightLightInSmallOnesStayFinite) {
    for (const auto& [metres, light] :
         {std::pair{1e6, 1e-30}, {1e-3, 1e30}, {1e6, 1e30}, {1e-6, 1e-30}}) {
        SCOPED_TRACE(metres);
        SceneBuilder b;
        b.add_quad({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, b.add_material(lambert(V3f(0.5f))));
        b.scene.nodes[0].matrix = scaled(V3d(metres));
        b.place_light(point_light(V3d(light)), translated({0, 0, metres}));
        View view{{0, 0, 4 * metres}, {0, 0, 0}, 60, 16, 16}; // sees past the quad, too
        const FrameResult result = render_scene(b.scene, view, config());
        EXPECT_EQ(result.discarded_samples, 0u);
        const double expected = 0.5 / 3.14159265358979 * light / (metres * metres);
        EXPECT_NEAR(double((*result.image.find("R"))(8, 8)) / expected, 1,
                    expected > 1e-36 && expected < 1e38 ? 0.1 : 1.0);
    }
}

} // namespace
} // namespace ql
