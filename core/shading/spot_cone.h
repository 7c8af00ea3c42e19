// The light of a spot by the angle from its axis.
//
// Angles are given as h = 1 - cos, which stays exact for narrow cones where the cosine is 1 in
// float. Without an exponent the cone is that of KHR_lights_punctual, whose ramp from the inner to
// the outer angle is at least 1e-3 wide in h; with one, Nilles 2017, eq. 17. Plain values.
#pragma once

#include <Imath/ImathVec.h>

namespace ql {

struct SpotCone {
    float inner = 0;     // h of the angle where the ramp ends
    float outer = 2;     // h of the angle beyond which there is no light
    float exponent = -1; // negative: KHR_lights_punctual

    // The share of the axial intensity at h.
    float falloff(float h) const;
    // Of falloff over h: times 2 pi it is the flux for an axial intensity of 1.
    double integral() const;
    // h of a direction that is distributed as the falloff; u in [0, 1), from the axis to the rim
    // with an exponent.
    double sample(double u) const;
};

// angles: radians from the axis; exponent: negative for none.
SpotCone spot_cone(double inner_angle, double outer_angle, double exponent);

// 1 - cos of the angle between two unit vectors, without cancellation.
inline float one_minus_cos_between(const Imath::V3f& a, const Imath::V3f& b) {
    return 0.5f * (a - b).length2();
}

} // namespace ql
