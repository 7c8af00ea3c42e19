// Points on an emissive sphere or cone, for sampling its light.
//
// Points are uniform on the surface of the shape in its own space; where the node stretches the
// shape, the density in render space is the one that follows. Immutable.
#pragma once

#include "geometry/world.h"

namespace ql {

struct ShapePoint {
    V3f position; // render space
    V3f normal;   // unit, outward, render space
    V2f uv;       // texture coordinates, as of a hit there
};

class ShapeLight {
  public:
    // Of a surface that is a sphere or a cone.
    ShapeLight(const World& world, uint32_t surface);

    uint32_t surface() const { return m_surface; }
    // In render space, to 2 % where the node stretches the shape and exactly elsewhere.
    double area() const { return m_area; }

    // u in [0, 1).
    ShapePoint sample(V2f u) const;
    // One over the density of sample() per area, at a point with this unit normal: what the area
    // would be, were the shape stretched everywhere as it is there.
    float area_at(const V3f& normal) const;

  private:
    const Surface& surface_of() const { return m_world->surfaces[m_surface]; }
    double area_at(const V3d& normal) const;

    const World* m_world;
    uint32_t m_surface;
    double m_area_of_body = 0, m_determinant = 1, m_area = 0;
};

} // namespace ql
