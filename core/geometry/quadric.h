// Spheres and cones in their own space, intersected in double precision.
//
// Both are closed surfaces: a ray finds them from outside and from inside, a cone has its two end
// discs. Axis y, centre at the origin, as in KHR_implicit_shapes.
#pragma once

#include "scene/scene.h"

#include <optional>

namespace ql {

struct QuadricHit {
    double t;
    V3d normal; // outward, unit length in the shape's own space
    V2f uv;     // sphere: longitude and latitude; cone side: angle and height; discs: angle, radius
};

// The nearest hit with t_near < t < t_far. The direction need not be normalised.
std::optional<QuadricHit> intersect_shape(const ImplicitShape& shape, const V3d& origin,
                                          const V3d& direction, double t_near, double t_far);

double shape_area(const ImplicitShape& shape);

struct BodyPoint {
    V3d position, normal; // outward, unit length
    V2f uv;               // as of a hit there
};
// Uniform over the surface for u, v uniform in [0, 1). The area must not be 0.
BodyPoint uniform_point(const ImplicitShape& shape, double u, double v);

// A point on a cone, moved along its surface until it is `margin` away from the rims, or where it
// is.
V3d off_cone_rim(const ImplicitShape& cone, const V3d& p, double margin);

// Half the extent of the shape's box in its own space.
V3d half_extent(const ImplicitShape& shape);

} // namespace ql
