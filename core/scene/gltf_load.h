// One or more glTF 2.0 files (.gltf, .glb) composed into one Scene.
//
// tinygltf parses; what it leaves unchecked (bounds, indices, cycles, sizes, ranges) is checked
// here, so that no file can crash a tool. Extensions: see kSupportedExtensions in
// gltf_validate.cpp. The suite's own extensions:
//   QL_materials_phong       material: kd, ks, kr, kt, exponent, ior, diffuseColor, specularColor,
//                            diffuseTexture, fresnel ("exact" or "schlick")
//   QL_lights_spot_exponent  light of KHR_lights_punctual: exponent
//   KHR_implicit_shapes      node: {"shape": index}; QL_shape_material: {"material": index}
#pragma once

#include "base/parallel.h"
#include "scene/scene.h"

#include <cstddef>
#include <string>
#include <vector>

namespace ql {

struct GltfLoadConfig {
    size_t max_file_bytes = size_t(1) << 32;     // of each file; glTF's own limit is 4 GiB
    size_t max_elements = size_t(1) << 28;       // vertices and indices of a file together
    size_t max_texture_pixels = size_t(1) << 28; // of each image
};

struct LoadedScene {
    Scene scene;
    std::vector<std::string> warnings; // one line each, with the name of the file
};

// The default scenes of all files side by side in one world. A scene without camera or light is
// fine; one without any triangle or shape is not. Errors: ErrorKind::input, one line.
LoadedScene load_gltf(const std::vector<std::string>& paths, const GltfLoadConfig& config,
                      const Workers& workers);

} // namespace ql
