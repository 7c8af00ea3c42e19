// Photons leaving the lights: points, directions and flux.
//
// Lights are picked in proportion to their power; points on area lights are uniform, directions
// follow the cosine; point lights send out uniformly, spots in proportion to their intensity;
// directional lights through a disc that covers the scene. Every photon of one light then carries
// the same flux, up to textures. The reverse of LightSet::sample; powers are those of LightSet.
// Immutable, hence safe to share between threads. The LightSet must outlive it.
#pragma once

#include "shading/lights.h"

namespace ql {

struct EmittedPhoton {
    V3f origin;    // render space, off the surface of the light
    V3f direction; // unit
    V3f flux;      // in units of LightEmission::power; its mean over colours is about 1
    V3f intensity; // of a point or spot light in this direction over the greatest; else 0
};

class LightEmission {
  public:
    explicit LightEmission(const LightSet& lights);

    bool empty() const { return m_lights.empty(); }
    // Mean over R, G, B of the flux of all lights, in units of LightSet and render space:
    // watts times RenderSpace::scale^2 times 2^-exponent.
    double power() const { return m_power; }
    // Whether all lights are point or spot lights: then photons have an intensity.
    bool is_punctual() const { return m_is_punctual; }
    // The greatest intensity, mean over R, G, B, in units of LightSet and render space.
    double greatest_intensity() const { return m_greatest_intensity; }

    // All of u in [0, 1).
    EmittedPhoton sample(double u_pick, V2f u_position, V2f u_direction) const;

  private:
    EmittedPhoton from_point(const LightSet::Punctual& light, V2f u) const;
    EmittedPhoton from_spot(const LightSet::Punctual& light, V2f u) const;
    EmittedPhoton from_far(const LightSet::Punctual& light, V2f u) const;
    EmittedPhoton from_triangle(const LightSet::Triangle& light, V2f u_position, float u_side,
                                V2f u_direction) const;
    EmittedPhoton from_shape(const ShapeLight& light, V2f u_position, float u_side,
                             V2f u_direction) const;

    const LightSet& m_lights;
    double m_power = 0;
    bool m_is_punctual = true;
    double m_greatest_intensity = 0;
};

} // namespace ql
