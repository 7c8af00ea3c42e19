// What can be said about a glTF model as a whole: version, extensions, the node tree.
#pragma once

#include "scene/gltf_import.h"

#include <string>
#include <vector>

namespace ql {

// glTF 2.x and no required extension that we lack. Errors: ErrorKind::input.
void check_asset(const tinygltf::Model& model, const std::string& file);

// Explains a model that could not be read by the compression it uses, if it uses any.
void check_compression(const tinygltf::Model& model, const std::string& file);

// A warning for each optional extension that we lack.
void warn_of_extensions(GltfImport& in);

// Every child exists, has one parent, and there is no cycle. The result is the parent of each
// node, -1 for roots.
std::vector<int> checked_parents(const GltfImport& in);

// Roots of the default scene: that of `scene`, else the first, else all nodes without parent.
std::vector<int> default_roots(const GltfImport& in, const std::vector<int>& parents);

} // namespace ql
