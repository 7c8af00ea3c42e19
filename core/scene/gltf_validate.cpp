#include "scene/gltf_validate.h"

#include <tiny_gltf.h>

#include <array>
#include <string_view>

namespace ql {

namespace {

constexpr std::array<std::string_view, 16> kSupportedExtensions = {
    "EXT_texture_webp",
    "KHR_implicit_shapes",
    "KHR_lights_punctual",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "QL_lights_spot_exponent",
    "QL_materials_phong",
    "QL_shape_material",
};

// Refused where it turns out that there is no uncompressed data beside the compressed.
constexpr std::array<std::string_view, 2> kCheckedAtUse = {
    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression",
};

template<class List>
bool contains(const List& list, std::string_view name) {
    return std::find(list.begin(), list.end(), name) != list.end();
}

void check_version(const tinygltf::Asset& asset, const std::string& file) {
    if (!asset.version.starts_with("2."))
        throw input_error("{}: glTF version {}, expected 2.0", file, asset.version);
    if (!asset.minVersion.empty() && asset.minVersion != "2.0")
        throw input_error("{}: needs glTF version {}, expected 2.0", file, asset.minVersion);
}

} // namespace

void check_asset(const tinygltf::Model& model, const std::string& file) {
    check_version(model.asset, file);
    for (const std::string& name : model.extensionsRequired)
        if (!contains(kSupportedExtensions, name) && !contains(kCheckedAtUse, name))
            throw input_error("{}: requires the extension {}, which is not supported", file, name);
}

void check_compression(const tinygltf::Model& model, const std::string& file) {
    for (const char* name : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
        if (contains(model.extensionsUsed, name) || contains(model.extensionsRequired, name))
            throw input_error("{}: compressed with {} without uncompressed data beside it, which "
                              "is not supported",
                              file, name);
}

void warn_of_extensions(GltfImport& in) {
    for (const std::string& name : in.model.extensionsUsed)
        if (!contains(kSupportedExtensions, name) && !contains(kCheckedAtUse, name))
            in.warn("ignores the extension {}", name);
}

std::vector<int> checked_parents(const GltfImport& in) {
    const auto& nodes = in.model.nodes;
    std::vector<int> parents(nodes.size(), -1);
    for (size_t i = 0; i < nodes.size(); ++i)
        for (const int child : nodes[i].children) {
            in.at(nodes, child, fmt::format("node {}", i), "child");
            int& parent = parents[size_t(child)];
            if (parent >= 0)
                throw in.error("node {}: child of node {} and of node {}", child, parent, i);
            parent = int(i);
        }

    // With one parent each, every node that no root leads to is on a cycle or below one.
    std::vector<int> open;
    for (size_t i = 0; i < nodes.size(); ++i)
        if (parents[i] < 0) open.push_back(int(i));
    std::vector<char> reached(nodes.size(), 0);
    while (!open.empty()) {
        const size_t node = size_t(open.back());
        open.pop_back();
        reached[node] = 1;
        open.insert(open.end(), nodes[node].children.begin(), nodes[node].children.end());
    }
    for (size_t i = 0; i < nodes.size(); ++i)
        if (!reached[i]) throw in.error("node {}: its parents form a cycle", i);
    return parents;
}

std::vector<int> default_roots(const GltfImport& in, const std::vector<int>& parents) {
    std::vector<int> roots;
    if (in.model.scenes.empty()) {
        for (size_t i = 0; i < parents.size(); ++i)
            if (parents[i] < 0) roots.push_back(int(i));
        return roots;
    }
    const int index = std::max(in.model.defaultScene, 0);
    roots = in.at(in.model.scenes, index, "default scene", "scene").nodes;
    std::vector<char> listed(parents.size(), 0);
    for (const int root : roots) {
        in.at(in.model.nodes, root, fmt::format("scene {}", index), "node");
        if (parents[size_t(root)] >= 0)
            throw in.error("scene {}: node {} is a child of node {}, expected a root", index, root,
                           parents[size_t(root)]);
        if (listed[size_t(root)]) throw in.error("scene {}: node {} is listed twice", index, root);
        listed[size_t(root)] = 1;
    }
    return roots;
}

} // namespace ql
