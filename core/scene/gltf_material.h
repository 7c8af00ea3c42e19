// glTF materials and the textures they read. Only what a surface of the scene uses is imported, and
// only textures that can make a difference (none for a factor of zero).
#pragma once

#include "base/parallel.h"
#include "image/picture_decode.h"
#include "scene/gltf_import.h"

#include <string>
#include <vector>

namespace ql {

// Index of the scene's material for that of the file; -1 is glTF's default material. `where` says
// who uses it.
int import_material(GltfImport& in, int material, const std::string& where);

// Decodes the images of all textures that the imported materials read.
void decode_textures(GltfImport& in, const Workers& workers);

} // namespace ql
