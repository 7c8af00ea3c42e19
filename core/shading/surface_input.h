// From the point that a ray met to what its material is asked with.
#pragma once

#include "geometry/surface_point.h"
#include "shading/material.h"

namespace ql {

// wo points away from the surface, towards the viewer.
inline SurfaceInput surface_input(const SurfacePoint& point, const V3f& wo) {
    return {{point.uv[0], point.uv[1]}, point.color, point.ng.dot(wo) >= 0};
}

} // namespace ql
