// The lights that get a reflective shadow map: point, spot and directional ones that shine.
//
// Lengths are those of render space; intensities are stored as in LightSet: W/sr times
// RenderSpace::scale^2 (directional: W/m^2), divided by 2^LightSet::exponent. Plain values.
#pragma once

#include "render/posed_scene.h"

#include <string>
#include <vector>

namespace ql {

struct MapLight {
    std::string name; // of the light or its node, or its number
    Light::Kind kind = Light::Kind::point;
    V3f position = {0, 0, 0};
    V3f axis = {0, 0, -1};     // unit, the way it shines
    V3f intensity = {0, 0, 0}; // along the axis
    double outer_angle = 0;    // spot: radians from the axis
    SpotCone cone;
};

// Lights of no intensity, no cone or no direction are left out: they need no map.
std::vector<MapLight> map_lights(const PosedScene& scene);

// Intensity towards a unit direction that leaves the light; directional: its irradiance.
V3f intensity_towards(const MapLight& light, const V3f& direction);

// What reaches a point from a light, before any shadow.
struct Incidence {
    V3f to_light = {0, 0, 0}; // unit
    V3f target = {0, 0, 0};   // must be seen from the point; unused if distant
    bool distant = false;
    V3f irradiance = {0, 0, 0}; // on a surface that faces the light

    // From near the point to the light.
    Ray shadow_ray(const V3f& origin) const;
};
Incidence incidence_at(const MapLight& light, const V3f& point);

} // namespace ql
