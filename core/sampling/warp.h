// Maps from the unit square to directions and surfaces, with inverses.
//
// Directions are unit vectors, z up; u is in [0, 1)^2; angles in radians. Maps preserve
// stratification; all are pure functions.
#pragma once

#include <Imath/ImathVec.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace ql {

using Imath::V2f;
using Imath::V3f;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr float kInvPi = std::numbers::inv_pi_v<float>;

// --- Sine and cosine -----------------------------------------------------------------------------

struct SinCos {
    float sin;
    float cos;
};

// For |x| <= pi/4: the Taylor series, whose first terms left out are below 2e-9 and 3e-8 there.
inline SinCos sin_cos_eighth(float x) {
    const float s = x * x;
    return {x * (1 + s * (-1.f / 6 + s * (1.f / 120 + s * (-1.f / 5040 + s * (1.f / 362880))))),
            1 + s * (-0.5f + s * (1.f / 24 + s * (-1.f / 720 + s * (1.f / 40320))))};
}

// Of 2 pi turns, for turns in [0, 1].
inline SinCos sin_cos_turns(float turns) {
    const float quarters = turns * 4;
    const int quadrant = static_cast<int>(quarters + 0.5f);
    const SinCos r = sin_cos_eighth((quarters - static_cast<float>(quadrant)) * (kPi / 2));
    const float s = (quadrant & 1) ? r.cos : r.sin;
    const float c = (quadrant & 1) ? r.sin : r.cos;
    return {(quadrant & 2) ? -s : s, ((quadrant + 1) & 2) ? -c : c};
}

// --- Frames --------------------------------------------------------------------------------------

// Right-handed orthonormal axes; local z is n.
struct Frame {
    V3f s = {1, 0, 0};
    V3f t = {0, 1, 0};
    V3f n = {0, 0, 1};

    V3f world_from_local(const V3f& v) const { return s * v.x + t * v.y + n * v.z; }
    V3f local_from_world(const V3f& v) const { return {s.dot(v), t.dot(v), n.dot(v)}; }
};

// For a unit normal. Duff et al., "Building an orthonormal basis, revisited", JCGT 6 (2017).
// Continuous but across n.z = 0, where no frame of the whole sphere can be.
inline Frame frame_from_normal(const V3f& n) {
    const float sign = n.z < 0 ? -1.0f : 1.0f; // the same for both zeros
    const float a = -1 / (sign + n.z);
    const float b = n.x * n.y * a;
    return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}, n};
}

// a where the mask is all ones, b where it is all zeros.
inline float selected(uint32_t mask, float a, float b) {
    return std::bit_cast<float>((std::bit_cast<uint32_t>(a) & mask) |
                                (std::bit_cast<uint32_t>(b) & ~mask));
}

// --- Disk ----------------------------------------------------------------------------------------

// Shirley & Chiu, "A low distortion map between disk and square", JGT 2 (1997).
inline V2f square_to_uniform_disk(const V2f& u) {
    const float a = 2 * u.x - 1;
    const float b = 2 * u.y - 1;
    // The larger and the smaller coordinate by integer masks, not by a branch: which half a random
    // point falls into cannot be predicted.
    const uint32_t horizontal = std::abs(a) > std::abs(b) ? ~0u : 0u;
    const float r = selected(horizontal, a, b);
    const float q = selected(horizontal, b, a);
    constexpr float kLeast = 1e-30f; // at the centre any angle will do
    const SinCos angle = sin_cos_eighth(kPi / 4 * (q / (std::abs(r) + kLeast)));
    // q / |r| has the sign of q; with a negative r the angle turns the other way.
    const float along = r * angle.cos;
    const float across = std::abs(r) * angle.sin;
    return {selected(horizontal, along, across), selected(horizontal, across, along)};
}
inline V2f uniform_disk_to_square(const V2f& p) {
    const bool horizontal = std::abs(p.x) > std::abs(p.y);
    const float r = std::copysign(p.length(), horizontal ? p.x : p.y);
    if (r == 0) return {0.5f, 0.5f};
    const float q = std::atan(horizontal ? p.y / p.x : p.x / p.y) * (4 * kInvPi) * r;
    return horizontal ? V2f{(r + 1) / 2, (q + 1) / 2} : V2f{(q + 1) / 2, (r + 1) / 2};
}

// --- Sphere, hemispheres, cone -------------------------------------------------------------------

// A direction whose z is 1 - h, from a point of the disk: equal areas go to equal areas.
inline V3f cap_from_disk(const V2f& disk, float height_scale) {
    const float h = disk.length2() * height_scale; // 1 - cos(theta)
    const float scale = std::sqrt(height_scale * std::max(0.0f, 2 - h));
    return {disk.x * scale, disk.y * scale, 1 - h};
}
inline V2f disk_from_cap(const V3f& v, float height_scale) {
    // 1 - z without cancellation on the upper side.
    const float h = v.z > 0 ? (v.x * v.x + v.y * v.y) / (1 + v.z) : 1 - v.z;
    const float scale = std::sqrt(height_scale * std::max(0.0f, 2 - h));
    return scale > 0 ? V2f{v.x / scale, v.y / scale} : V2f{1, 0};
}

inline V3f square_to_uniform_sphere(const V2f& u) {
    return cap_from_disk(square_to_uniform_disk(u), 2);
}
inline V2f uniform_sphere_to_square(const V3f& v) {
    return uniform_disk_to_square(disk_from_cap(v, 2));
}

inline V3f square_to_uniform_hemisphere(const V2f& u) {
    return cap_from_disk(square_to_uniform_disk(u), 1);
}
inline V2f uniform_hemisphere_to_square(const V3f& v) {
    return uniform_disk_to_square(disk_from_cap(v, 1));
}

// Directions within an angle of z. The cone is given by 1 - cos(angle) = 2 sin^2(angle / 2), in
// (0, 2], which stays exact for narrow cones.
inline float one_minus_cos(float angle) {
    const float s = std::sin(angle / 2);
    return 2 * s * s;
}
inline V3f square_to_uniform_cone(const V2f& u, float cone_one_minus_cos) {
    return cap_from_disk(square_to_uniform_disk(u), cone_one_minus_cos);
}
inline V2f uniform_cone_to_square(const V3f& v, float cone_one_minus_cos) {
    return uniform_disk_to_square(disk_from_cap(v, cone_one_minus_cos));
}

// Malley: project the disk up. z may be 0 at the rim.
inline V3f square_to_cosine_hemisphere(const V2f& u) {
    const V2f d = square_to_uniform_disk(u);
    return {d.x, d.y, std::sqrt(std::max(0.0f, 1 - d.length2()))};
}
inline V2f cosine_hemisphere_to_square(const V3f& v) {
    return uniform_disk_to_square({v.x, v.y});
}

// --- Cosine power lobe about z -------------------------------------------------------------------

// Density (n + 1)/(2 pi) cos^n(theta), n in [0, 1e7]. In logarithms, because 1 - cos^2 is zero in
// float from n = 1e8 on and wrong by 0.5 % at 1e6.
inline V3f square_to_cosine_power(const V2f& u, float exponent) {
    const float log_cos = std::log1p(-u.x) / (exponent + 1);
    const float sine = std::sqrt(-std::expm1(2 * log_cos));
    const SinCos phi = sin_cos_turns(u.y);
    return {sine * phi.cos, sine * phi.sin, std::exp(log_cos)};
}
// cos^n of the angle between two unit vectors, 0 beyond 90 degrees; from their difference, because
// their dot product leaves nothing of 1 - cos for narrow lobes.
inline float cosine_power(const V3f& a, const V3f& b, float exponent) {
    const float one_minus = 0.5f * (a - b).length2();
    return one_minus < 1 ? std::exp(exponent * std::log1p(-one_minus)) : 0;
}
inline V2f cosine_power_to_square(const V3f& v, float exponent) {
    const float log_cos = 0.5f * std::log1p(-std::min(1.0f, v.x * v.x + v.y * v.y));
    float turns = std::atan2(v.y, v.x) * (kInvPi / 2);
    if (turns < 0) turns += 1;
    return {-std::expm1((exponent + 1) * log_cos), turns};
}

// --- Triangle ------------------------------------------------------------------------------------

// Barycentric weights of vertices 1 and 2; vertex 0 has the rest. Heitz, "A low-distortion map
// between triangle and square" (2019).
inline V2f square_to_uniform_triangle(const V2f& u) {
    return u.y > u.x ? V2f{u.x / 2, u.y - u.x / 2} : V2f{u.x - u.y / 2, u.y / 2};
}
inline V2f uniform_triangle_to_square(const V2f& b) {
    return b.y > b.x ? V2f{2 * b.x, b.x + b.y} : V2f{b.x + b.y, 2 * b.y};
}

} // namespace ql
