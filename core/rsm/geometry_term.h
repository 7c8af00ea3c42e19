// The geometry term between a receiver and the texel of a map, bounded near corners.
//
//   max(0, n_p . d) max(0, -n . d) / |x - x_p|^2   with d the unit vector from x_p to x
// The divisor is bounded by treating the texel as a disc of its own area A (d^2 + A/pi), by a
// distance, or not at all (Nilles 2017, section 5.1, bounds it by 1). Render space; pure functions.
#pragma once

#include "geometry/ray.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace ql {

// The divisor of the geometry term becomes max(d^2 + radius2_scale * A/pi, least_distance2).
struct GeometryBound {
    float radius2_scale = 1;   // 1: disc; 0: none
    float least_distance2 = 0; // render lengths, squared

    float divisor(float distance2, float radius2) const {
        return std::max(distance2 + radius2_scale * radius2, least_distance2);
    }
};

struct Receiver {
    V3f position = {0, 0, 0};
    V3f ng = {0, 0, 1}; // unit, geometric
    V3f ns = {0, 0, 1}; // unit, shading
    float offset = 0;   // shadow rays start that far off the surface
};

// A texel whose plane holds the receiver up to rounding (positions are good to about 2^-24 in
// render space) gives no light, nor does the receiver's plane.
inline constexpr float kPlaneNoise = 0x1p-22f;

// Texels side by side, one array for each value; radius2 is A/pi.
struct TexelArrays {
    const float *px, *py, *pz;
    const float *nx, *ny, *nz;
    const float* radius2;
};

// The terms of the first `count` texels; 0 where either faces away.
void bounded_geometry(const Receiver& receiver, const TexelArrays& texels, size_t count,
                      const GeometryBound& bound, float* terms);

// Of one texel.
float bounded_geometry(const Receiver& receiver, const V3f& position, const V3f& normal,
                       float radius2, const GeometryBound& bound);

} // namespace ql
