// The nodes of the default scene with what hangs on them: meshes, shapes, cameras and lights.
#pragma once

#include "scene/gltf_import.h"

namespace ql {

// Parents before children. Cameras and lights are copied for each node that refers to them.
void import_nodes(GltfImport& in);

} // namespace ql
