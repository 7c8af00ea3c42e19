#include "bluenoise/permute.h"
#include "bluenoise/reproject.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ql {
namespace {

TEST(Reproject, CameraMotionIsWhatProjectionSays) {
    // A camera at the origin along +z, focal length 1: ndc = (0.5 + x / z, 0.5 + y / z).
    Imath::M44f ndc(1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 1, 0, 0, 1, 0);
    // The next camera stands 0.1 to the right and 0.2 up (y down): points move the other way.
    Imath::M44f shift;
    shift.setTranslation(Imath::V3f(-0.1f, 0.2f, 0));
    Array2D<float> depth(20, 10, 2.0f);
    depth(3, 3) = std::numeric_limits<float>::infinity();
    depth(4, 3) = 0;
    const MotionPlanes motion = camera_motion(depth, Imath::M44f(), ndc, shift * ndc);
    EXPECT_NEAR(motion.x(10, 7), -0.05 * 20, 1e-5);
    EXPECT_NEAR(motion.y(10, 7), 0.1 * 10, 1e-5);
    EXPECT_TRUE(std::isnan(motion.x(3, 3)));
    EXPECT_TRUE(std::isnan(motion.y(4, 3)));
    EXPECT_EQ(mean_motion(motion, {0, 0, 20, 10}, 4), Imath::V2i(-1, 1));
    EXPECT_EQ(mean_motion(motion, {3, 3, 5, 4}, 4), Imath::V2i(0, 0));
    EXPECT_EQ(
        mean_motion({Array2D<float>(2, 2, 9.0f), Array2D<float>(2, 2, -2.6f)}, {0, 0, 2, 2}, 4),
        Imath::V2i(4, -3));
}

TEST(Guides, SurfacesAreToldApart) {
    Image guide(2, 1);
    EXPECT_TRUE(surface_numbers(guide).empty());
    guide.plane("N.X").values() = {1, 0};
    EXPECT_NE(surface_numbers(guide)[0], surface_numbers(guide)[1]);
    guide.plane("N.X").values() = {1, 0.95f};
    EXPECT_EQ(surface_numbers(guide)[0], surface_numbers(guide)[1]);
    guide.uint_plane("id").values() = {4, 5};
    EXPECT_NE(surface_numbers(guide)[0], surface_numbers(guide)[1]);
}

TEST(Guides, IntensityIsLuminance) {
    Image image(1, 1);
    image.plane("R")[0] = 1;
    image.plane("G")[0] = 2;
    EXPECT_THROW(intensity_plane(image, "i"), Error);
    image.plane("B")[0] = 3;
    EXPECT_EQ(intensity_plane(image, "i")[0], luminance(1, 2, 3));
}

TEST(Demodulated, IntensityForgetsTheTexture) {
    Image image(3, 1);
    auto &r = image.plane("albedo.R"), &g = image.plane("albedo.G"), &b = image.plane("albedo.B");
    for (Array2D<float>* plane : {&r, &g, &b}) {
        (*plane)[0] = 0.25f;
        (*plane)[1] = 0.5f;
        (*plane)[2] = 0;
    }
    Array2D<float> intensity(3, 1);
    intensity[0] = 1, intensity[1] = 2, intensity[2] = 3;
    const Array2D<float> even = demodulated(intensity, image, "i");
    EXPECT_FLOAT_EQ(even[0], 4);
    EXPECT_FLOAT_EQ(even[1], 4);
    EXPECT_EQ(even[2], 3); // black: as it is
    EXPECT_THROW(demodulated(intensity, Image(3, 1), "i"), Error);
}

TEST(Guides, PixelsWithoutASurfaceHaveNoMotion) {
    Image image(2, 1);
    image.plane("motion.X") = Array2D<float>(2, 1, {4, 0});
    image.plane("motion.Y") = Array2D<float>(2, 1, {-2, 0});
    EXPECT_EQ(mean_motion(*motion_planes(image), {0, 0, 2, 1}, 9), Imath::V2i(2, -1));
    image.uint_plane("id") = Array2D<uint32_t>(2, 1, {7, 0});
    EXPECT_EQ(mean_motion(*motion_planes(image), {0, 0, 2, 1}, 9), Imath::V2i(4, -2));
    image.uint_plane("id") = Array2D<uint32_t>(2, 1, {7, 7});
    image.plane("Z") = Array2D<float>(2, 1, {1, 0});
    EXPECT_EQ(mean_motion(*motion_planes(image), {0, 0, 2, 1}, 9), Imath::V2i(4, -2));
}

} // namespace
} // namespace ql
