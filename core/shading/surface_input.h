// From the point that a ray met to what its material is asked with.
#pragma once

#include "geometry/surface_point.h"
#include "shading/material.h"

namespace ql {

// wo points away from the surface, towards the viewer.
inline SurfaceInput surface_input(const SurfacePoint& point, const V3f& wo) {
    return {{point.uv[0], point.uv[1]}, point.color, point.ng.dot(wo) >= 0};
}

// The front of a triangle at barycentric coordinates, or of a shape at texture coordinates, where
// no ray has been.
inline SurfaceInput surface_input_at(const World& world, uint32_t surface_index, uint32_t primitive,
                                     float u, float v) {
    const Surface& surface = world.surfaces[surface_index];
    SurfacePoint point;
    if (surface.kind != Surface::Kind::triangles) {
        point.uv[0] = point.uv[1] = V2f(u, v);
        return surface_input(point, point.ng);
    }
    const Mesh& mesh = world.scene->meshes[size_t(surface.mesh)];
    detail::add_texture_coordinates(mesh, mesh.triangles[primitive],
                                    {0, u, v, surface_index, primitive, point.ng}, point);
    return surface_input(point, point.ng);
}

} // namespace ql
