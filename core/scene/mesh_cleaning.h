// Makes a mesh fit for rendering: vertices that are not finite and triangles without area go,
// vertices that no triangle uses go, directions get unit length, colours are put into [0, 1].
#pragma once

#include "scene/scene.h"

#include <cstdint>

namespace ql {

struct MeshCleaning {
    uint64_t non_finite_vertices = 0;  // positions with an infinity or NaN
    uint64_t degenerate_triangles = 0; // of exactly zero area (in double precision)
    uint64_t broken_attributes = 0;    // other values that had to be replaced
};

// A zero normal becomes the area-weighted mean of the normals around it; a mesh with a tangent of
// length zero loses its tangents. All indices of the mesh must be in range.
MeshCleaning clean_mesh(Mesh& mesh);

} // namespace ql
