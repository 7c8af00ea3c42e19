// A glTF file as tinygltf's model: container and JSON checked before, buffers read, images kept as
// the bytes they are.
#pragma once

#include "scene/gltf_load.h"

#include <memory>
#include <string>

namespace tinygltf {
class Model;
}

namespace ql {

// path "-" is standard input. Files named by the glTF are looked for relative to its folder.
// Errors: ErrorKind::input, one line.
std::shared_ptr<const tinygltf::Model> read_gltf_file(const std::string& path,
                                                      const GltfLoadConfig& config);

} // namespace ql
