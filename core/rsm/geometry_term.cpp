#include "rsm/geometry_term.h"

#include "base/wide_kernel.h"

namespace ql {

// Keeps 0/0 away where a texel lies on the receiver; d^4 is 1e-26 at the distances that rounding
// allows.
constexpr float kTiny = 1e-35f;

// Written for the vectoriser: no branches.
QL_WIDE_KERNEL
void bounded_geometry(const Receiver& receiver, const TexelArrays& texels, size_t count,
                      const GeometryBound& bound, float* terms) {
    const float* __restrict px = texels.px;
    const float* __restrict py = texels.py;
    const float* __restrict pz = texels.pz;
    const float* __restrict nx = texels.nx;
    const float* __restrict ny = texels.ny;
    const float* __restrict nz = texels.nz;
    const float* __restrict radius2 = texels.radius2;
    float* __restrict out = terms;
    const V3f x = receiver.position, ng = receiver.ng, ns = receiver.ns;
    const float scale = bound.radius2_scale, least = bound.least_distance2;
    for (size_t i = 0; i < count; ++i) {
        const float dx = px[i] - x.x, dy = py[i] - x.y, dz = pz[i] - x.z;
        const float d2 = dx * dx + dy * dy + dz * dz;
        const float at_texel = -(nx[i] * dx + ny[i] * dy + nz[i] * dz);
        const float at_plane = ng.x * dx + ng.y * dy + ng.z * dz;
        const float at_receiver = ns.x * dx + ns.y * dy + ns.z * dz;
        const float widened = d2 + scale * radius2[i];
        const float divisor = widened > least ? widened : least;
        const float lit = at_texel > kPlaneNoise ? at_texel : 0.0f;
        const float facing = at_plane > kPlaneNoise ? at_receiver : 0.0f;
        out[i] = lit * (facing > 0 ? facing : 0.0f) / (d2 * divisor + kTiny);
    }
}

float bounded_geometry(const Receiver& receiver, const V3f& position, const V3f& normal,
                       float radius2, const GeometryBound& bound) {
    float term;
    bounded_geometry(
        receiver,
        {&position.x, &position.y, &position.z, &normal.x, &normal.y, &normal.z, &radius2}, 1,
        bound, &term);
    return term;
}

} // namespace ql
