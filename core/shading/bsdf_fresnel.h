// Share of unpolarised light that a smooth boundary reflects. Pure functions.
#pragma once

#include <Imath/ImathVec.h>

#include <cmath>

namespace ql {

using Imath::V3f;

// Exact, for dielectrics. cos_i in [0, 1] on the side where the light comes from; eta: index of the
// other side over the index of this side. 1 beyond the critical angle, and for eta = 0.
// Cook & Torrance 1982, eq. 3, with g - c written as (eta^2 - 1)/(g + c): nothing cancels for eta
// near 1, where the usual form has lost all digits.
inline float dielectric_fresnel(float cos_i, float eta) {
    const float c = cos_i;
    const float excess = (eta - 1) * (eta + 1);
    if (excess == 0) return 0;
    const float g2 = excess + c * c;
    if (g2 <= 0) return 1;
    const float g = std::sqrt(g2);
    const float a = excess / ((g + c) * (g + c)); // (g - c)/(g + c)
    const float b = (c * (g + c) - 1) / (c * excess / (g + c) + 1);
    return 0.5f * a * a * (1 + b * b);
}

inline float schlick_share(float cos_i) {
    const float m = 1 - cos_i;
    const float m2 = m * m;
    return m2 * m2 * m;
}

// Schlick 1994 with the reflectance at normal incidence: what glTF uses for metals.
inline V3f schlick_fresnel(const V3f& f0, float cos_i) {
    return f0 + (V3f(1) - f0) * schlick_share(cos_i);
}

// Nilles 2017, eq. 15 and 16: Schlick from the two indices, on either side with the angle on this
// side; total internal reflection is added, which the approximation lacks.
inline float schlick_dielectric_fresnel(float cos_i, float eta) {
    if ((eta - 1) * (eta + 1) + cos_i * cos_i <= 0) return 1;
    const float r = (eta - 1) / (eta + 1);
    const float f0 = r * r;
    return f0 + (1 - f0) * schlick_share(cos_i);
}

} // namespace ql
