// glTF animations of the nodes of the default scene. All animations of a file play together; where
// two move the same thing, the first one counts.
#pragma once

#include "scene/gltf_import.h"

namespace ql {

void import_animations(GltfImport& in);

} // namespace ql
