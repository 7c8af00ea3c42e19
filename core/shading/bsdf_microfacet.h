// The GGX microfacet distribution with height-correlated masking, about z.
//
// Sources: Walter et al. 2007 (distribution, refraction); Heitz, "Understanding the masking-
// shadowing function", JCGT 3 (2014); Dupuy & Benyoub, "Sampling visible GGX normals with spherical
// caps", CGF 42 (2023). alpha in (0, 1]; w and h are unit vectors with w.z > 0, h.z > 0.
#pragma once

#include "sampling/warp.h"

namespace ql {

// Density of normals, 1/sr. 1 - cos^2 is taken from x and y, which keeps narrow lobes exact.
inline float ggx_distribution(const V3f& h, float alpha) {
    const float a2 = alpha * alpha;
    const float d = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
    return a2 / (kPi * d * d);
}

// sqrt(alpha^2 + (1 - alpha^2) cos^2) = cos (1 + 2 Lambda).
inline float ggx_slope_length(float cosine, float alpha) {
    const float a2 = alpha * alpha;
    return std::sqrt(a2 + (1 - a2) * cosine * cosine);
}

// G2(o, i) / (4 cos_o): the value f cos_i of a reflected direction is F D times this.
inline float ggx_geometry(float cos_o, float cos_i, float alpha) {
    return 0.5f * cos_i /
           (cos_o * ggx_slope_length(cos_i, alpha) + cos_i * ggx_slope_length(cos_o, alpha));
}

// G1(o) / (4 cos_o): the density of a reflected direction is D times this.
inline float ggx_masking(float cos_o, float alpha) {
    return 0.5f / (cos_o + ggx_slope_length(cos_o, alpha));
}

// A normal h with density G1(w) D(h) max(0, w.h) / w.z per solid angle.
inline V3f sample_visible_normal(const V3f& w, float alpha, const V2f& u) {
    // Stretch to the hemisphere configuration.
    const V3f stretched = V3f(w.x * alpha, w.y * alpha, w.z).normalized();
    // Sample the spherical cap of directions that reflect towards it.
    const float z = (1 - u.y) * (1 + stretched.z) - stretched.z;
    const float sine = std::sqrt(std::max(0.0f, (1 - z) * (1 + z)));
    const SinCos phi = sin_cos_turns(u.x);
    const V3f h(sine * phi.cos + stretched.x, sine * phi.sin + stretched.y, z + stretched.z);
    // Unstretch the halfway vector.
    return V3f(h.x * alpha, h.y * alpha, std::max(0.0f, h.z)).normalized();
}

// The direction that w goes to when it passes a boundary with normal h, w.h > 0; eta: index of the
// other side over this side, beyond total reflection only.
inline V3f refracted(const V3f& w, const V3f& h, float eta) {
    const float c = w.dot(h);
    const float cos2_t = 1 - (1 - c * c) / (eta * eta);
    return -w / eta + h * (c / eta - std::sqrt(std::max(0.0f, cos2_t)));
}

inline V3f reflected(const V3f& w, const V3f& h) {
    return h * (2 * w.dot(h)) - w;
}

} // namespace ql
