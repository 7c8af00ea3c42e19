// How glTF materials refer to textures: image, sampler, coordinate set and KHR_texture_transform.
#pragma once

#include "scene/gltf_import.h"
#include "scene/gltf_value.h"

#include <optional>
#include <string>

namespace tinygltf {
struct NormalTextureInfo;
struct TextureInfo;
} // namespace tinygltf

namespace ql {

// Unused if the info names no texture. The texture is added to the scene, without texels yet.
TextureUse texture_use(GltfImport& in, const tinygltf::TextureInfo& info, Transfer transfer,
                       const std::string& where);
TextureUse texture_use(GltfImport& in, const tinygltf::NormalTextureInfo& info, Transfer transfer,
                       const std::string& where);
// The texture info of an extension.
TextureUse texture_use(GltfImport& in, const std::optional<ExtensionObject>& info,
                       Transfer transfer);

} // namespace ql
