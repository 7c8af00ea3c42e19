// KHR_materials_pbrSpecularGlossiness as metallic-roughness, after the conversion that Khronos
// publishes beside the (archived) extension: the metallic share m solves
//   0.04 (1 - m) + base m = specular  and  base (1 - m) (1 - 0.04) = diffuse (1 - max specular)
// for perceived brightness. Exact for plain dielectrics and plain metals.
#pragma once

#include "scene/gltf_value.h"

namespace tinygltf {
struct PbrMetallicRoughness;
}

namespace ql {

tinygltf::PbrMetallicRoughness converted_specular_glossiness(GltfImport& in,
                                                             const ExtensionObject& source);

} // namespace ql
