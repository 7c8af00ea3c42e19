// Lights of KHR_lights_punctual, with the exponent of QL_lights_spot_exponent.
#pragma once

#include "scene/gltf_import.h"

#include <string>

namespace ql {

// `where` says which node refers to the light.
Light light_from(GltfImport& in, int light, const std::string& where);

} // namespace ql
