// glTF primitives as triangle meshes: any mode of triangles, any index type or none; broken
// triangles dropped and counted, normals and tangents of unit length.
#pragma once

#include "scene/gltf_import.h"

namespace ql {

// Indices of the scene's meshes for the primitives of one glTF mesh; a mesh is imported once.
// Points and lines are left out with a warning.
const std::vector<int>& import_mesh(GltfImport& in, int mesh);

} // namespace ql
