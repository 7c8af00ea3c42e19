#include "sampling/warp.h"

#include "sampling/random.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

constexpr int kPoints = 2000;

V2f random_point(int i) {
    const RandomFloats u = CounterRandom(11, static_cast<uint64_t>(i)).block(0);
    return {u[0], u[1]};
}

template<class Warp, class Inverse>
void expect_inverse(Warp warp, Inverse inverse, float tolerance) {
    for (int i = 0; i < kPoints; ++i) {
        const V2f u = random_point(i);
        const V2f back = inverse(warp(u));
        EXPECT_NEAR(back.x, u.x, tolerance) << u.x << ' ' << u.y;
        EXPECT_NEAR(back.y, u.y, tolerance) << u.x << ' ' << u.y;
    }
}

TEST(SinCosTurns, AgreesWithTheLibrary) {
    for (int i = 0; i <= 4096; ++i) {
        const double turns = i / 4096.0;
        const SinCos r = sin_cos_turns(static_cast<float>(turns));
        EXPECT_NEAR(r.sin, std::sin(2 * std::numbers::pi * turns), 2e-7);
        EXPECT_NEAR(r.cos, std::cos(2 * std::numbers::pi * turns), 2e-7);
    }
}

TEST(Warps, AreUndoneByTheirInverses) {
    expect_inverse(square_to_uniform_disk, uniform_disk_to_square, 1e-5f);
    expect_inverse(square_to_uniform_sphere, uniform_sphere_to_square, 1e-4f);
    expect_inverse(square_to_uniform_hemisphere, uniform_hemisphere_to_square, 1e-5f);
    expect_inverse(square_to_cosine_hemisphere, cosine_hemisphere_to_square, 1e-5f);
    expect_inverse(square_to_uniform_triangle, uniform_triangle_to_square, 1e-6f);
    for (const float angle : {1e-4f, 0.3f, 2.0f}) {
        const float size = one_minus_cos(angle);
        expect_inverse([&](V2f u) { return square_to_uniform_cone(u, size); },
                       [&](V3f v) { return uniform_cone_to_square(v, size); }, 1e-4f);
    }
    for (const float exponent : {0.0f, 1.0f, 40.0f, 1e4f, 1e6f})
        expect_inverse([&](V2f u) { return square_to_cosine_power(u, exponent); },
                       [&](V3f v) { return cosine_power_to_square(v, exponent); }, 2e-4f);
}

TEST(Warps, GiveUnitVectors) {
    for (int i = 0; i < kPoints; ++i) {
        const V2f u = random_point(i);
        for (const V3f& v : {square_to_uniform_sphere(u), square_to_uniform_hemisphere(u),
                             square_to_cosine_hemisphere(u), square_to_uniform_cone(u, 1e-6f),
                             square_to_cosine_power(u, 1e6f)})
            EXPECT_NEAR(v.length2(), 1, 1e-6);
    }
}

TEST(Warps, AreFiniteOnTheEdgesOfTheSquare) {
    const float last = 1 - 0x1p-24f;
    for (const float x : {0.0f, 0.5f, last})
        for (const float y : {0.0f, 0.5f, last}) {
            const V2f u(x, y);
            for (const V3f& v : {square_to_uniform_sphere(u), square_to_uniform_hemisphere(u),
                                 square_to_cosine_hemisphere(u), square_to_uniform_cone(u, 2),
                                 square_to_cosine_power(u, 0), square_to_cosine_power(u, 1e7f)})
                EXPECT_NEAR(v.length(), 1, 1e-3) << x << ' ' << y;
            const V2f b = square_to_uniform_triangle(u);
            EXPECT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1) << x << ' ' << y;
        }
}

// The median angle of cos^n is where cos^(n + 1) = 1/2; in float 1 - cos^2 would be 0.5 % off.
TEST(CosinePower, KeepsTheWidthOfNarrowLobes) {
    for (const double n : {1e4, 1e6, 1e7}) {
        const V3f v = square_to_cosine_power({0.5f, 0}, static_cast<float>(n));
        EXPECT_NEAR(v.x / std::sqrt(-std::expm1(2 * std::log(0.5) / (n + 1))), 1, 1e-5) << n;
        // The value seen through the density is 1/2 of the peak as well.
        EXPECT_NEAR(cosine_power(v, {0, 0, 1}, static_cast<float>(n)), 0.5, 1e-3) << n;
    }
}

TEST(CosinePower, IsZeroBehindTheAxis) {
    EXPECT_EQ(cosine_power({0, 0, -1}, {0, 0, 1}, 0), 0);
    EXPECT_EQ(cosine_power({1, 0, 0}, {0, 0, 1}, 1), 0);
}

TEST(Frame, IsOrthonormalForEveryNormal) {
    for (int i = 0; i < kPoints; ++i) {
        V3f n = square_to_uniform_sphere(random_point(i));
        if (i == 0) n = {0, 0, 1};
        if (i == 1) n = {0, 0, -1};
        if (i == 2) n = V3f(1e-4f, 0, -1).normalized();
        const Frame f = frame_from_normal(n);
        EXPECT_NEAR(f.s.length(), 1, 1e-5);
        EXPECT_NEAR(f.t.length(), 1, 1e-5);
        EXPECT_NEAR(f.s.dot(f.t), 0, 1e-5);
        EXPECT_NEAR(f.s.dot(n), 0, 1e-5);
        EXPECT_NEAR(f.s.cross(f.t).dot(n), 1, 1e-5);
        const V3f v = square_to_uniform_sphere(random_point(i + kPoints));
        EXPECT_NEAR((f.world_from_local(f.local_from_world(v)) - v).length(), 0, 1e-5);
    }
}

} // namespace
} // namespace ql
