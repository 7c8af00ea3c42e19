#include "scene/gltf_mesh.h"

#include "scene/gltf_accessor.h"
#include "scene/gltf_material.h"
#include "scene/mesh_cleaning.h"

#include <tiny_gltf.h>

#include <numeric>

namespace ql {

namespace {

using Triangle = std::array<uint32_t, 3>;

const char* mode_name(int mode) {
    constexpr const char* kNames[] = {"points", "lines", "line loops", "line strips"};
    return kNames[mode];
}

// --- Triangles of the three modes (glTF 2.0, section 3.7.2.1) -----------------------------------

std::vector<Triangle> triangles_of(GltfImport& in, const std::vector<uint32_t>& indices, int mode,
                                   const std::string& where) {
    std::vector<Triangle> triangles;
    const size_t n = indices.size();
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        if (n % 3 != 0) in.warn("{}: {} indices, not a multiple of 3", where, n);
        triangles.reserve(n / 3);
        for (size_t i = 0; i + 2 < n; i += 3)
            triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
        for (size_t i = 0; i + 2 < n; ++i)
            triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    } else {
        for (size_t i = 0; i + 2 < n; ++i)
            triangles.push_back({indices[i + 1], indices[i + 2], indices[0]});
    }
    return triangles;
}

std::vector<Triangle> read_triangles(GltfImport& in, const tinygltf::Primitive& primitive,
                                     size_t vertices, const std::string& where) {
    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
        indices = read_index_accessor(in, primitive.indices, where);
    } else {
        in.spend(vertices, where);
        indices.resize(vertices);
        std::iota(indices.begin(), indices.end(), 0u);
    }
    for (const uint32_t index : indices)
        if (index >= vertices)
            throw in.error("{}: index {} of {} vertices", where, index, vertices);
    return triangles_of(in, indices, primitive.mode, where);
}

// --- Vertex attributes --------------------------------------------------------------------------

// The accessor of an attribute, or -1.
int attribute(const tinygltf::Primitive& primitive, const std::string& name) {
    const auto found = primitive.attributes.find(name);
    return found == primitive.attributes.end() ? -1 : found->second;
}

AccessorValues<float> read_attribute(GltfImport& in, int accessor, size_t vertices,
                                     const AccessorRule& rule) {
    AccessorValues<float> read = read_accessor<float>(in, accessor, rule);
    if (read.count != vertices)
        throw in.error("{}: {} values for {} vertices", rule.what, read.count, vertices);
    return read;
}

template<class Vector>
std::vector<Vector> as_vectors(const AccessorValues<float>& read) {
    std::vector<Vector> vectors(read.count, Vector(1));
    for (size_t i = 0; i < read.count; ++i)
        for (int c = 0; c < read.components; ++c)
            vectors[i][c] = read.values[i * size_t(read.components) + size_t(c)];
    return vectors;
}

template<class Vector>
std::vector<Vector> optional_attribute(GltfImport& in, const tinygltf::Primitive& primitive,
                                       const std::string& name, size_t vertices,
                                       const std::string& where, AccessorRule rule) {
    const int accessor = attribute(primitive, name);
    if (accessor < 0) return {};
    rule.what = where + " " + name;
    return as_vectors<Vector>(read_attribute(in, accessor, vertices, rule));
}

Mesh read_vertices(GltfImport& in, const tinygltf::Primitive& primitive, const std::string& where) {
    const AccessorRule directions3 = {"", 3, 3, IntegerRule::normalized};
    const AccessorRule directions4 = {"", 4, 4, IntegerRule::normalized};
    const AccessorRule uvs = {"", 2, 2, IntegerRule::any};
    const AccessorRule colors = {"", 3, 4, IntegerRule::normalized};
    Mesh mesh;
    mesh.positions = as_vectors<V3f>(read_accessor<float>(
        in, attribute(primitive, "POSITION"), {where + " POSITION", 3, 3, IntegerRule::any}));
    const size_t n = mesh.positions.size();
    mesh.normals = optional_attribute<V3f>(in, primitive, "NORMAL", n, where, directions3);
    // Without normals the surface is flat, and tangents would not lie in it.
    if (!mesh.normals.empty())
        mesh.tangents = optional_attribute<V4f>(in, primitive, "TANGENT", n, where, directions4);
    mesh.uvs[0] = optional_attribute<V2f>(in, primitive, "TEXCOORD_0", n, where, uvs);
    mesh.uvs[1] = optional_attribute<V2f>(in, primitive, "TEXCOORD_1", n, where, uvs);
    mesh.colors = optional_attribute<V4f>(in, primitive, "COLOR_0", n, where, colors);
    return mesh;
}

// --- Primitives ---------------------------------------------------------------------------------

bool has_triangles(GltfImport& in, const tinygltf::Primitive& primitive, const std::string& where) {
    if (primitive.mode < TINYGLTF_MODE_POINTS || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN)
        throw in.error("{}: mode {}, expected 0 to 6", where, primitive.mode);
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES) {
        in.warn("{}: {} are not rendered", where, mode_name(primitive.mode));
        return false;
    }
    const int positions = attribute(primitive, "POSITION");
    if (positions < 0) {
        in.warn("{}: no POSITION, nothing to render", where);
        return false;
    }
    const auto& accessor = in.at(in.model.accessors, positions, where + " POSITION", "accessor");
    if (primitive.extensions.contains("KHR_draco_mesh_compression") && accessor.bufferView < 0)
        throw in.error("{}: compressed with KHR_draco_mesh_compression without uncompressed data "
                       "beside it, which is not supported",
                       where);
    return true;
}

// A texture that reads coordinates which the mesh lacks would look wrong without a word.
void warn_of_missing_uvs(GltfImport& in, const Mesh& mesh, const std::string& where) {
    const Material& material = in.scene.materials[size_t(mesh.material)];
    for (const TextureUse* use :
         {&material.base_color_texture, &material.emission_texture, &material.normal_texture,
          &material.metallic_roughness_texture, &material.transmission_texture})
        if (use->used() && mesh.uvs[size_t(use->uv_set)].empty())
            in.warn("{}: no TEXCOORD_{} for the textures of its material", where, use->uv_set);
}

void report(GltfImport& in, const MeshCleaning& cleaning, const std::string& where) {
    in.scene.non_finite_vertices += cleaning.non_finite_vertices;
    in.scene.degenerate_triangles += cleaning.degenerate_triangles;
    if (cleaning.non_finite_vertices > 0)
        in.warn("{}: {} vertices that are not finite, left out with their triangles", where,
                cleaning.non_finite_vertices);
    if (cleaning.broken_attributes > 0)
        in.warn("{}: {} normals, tangents, texture coordinates or colours that are zero, not "
                "finite or out of range, replaced",
                where, cleaning.broken_attributes);
}

std::vector<int> imported_primitives(GltfImport& in, int index) {
    const auto& source = in.model.meshes[size_t(index)];
    std::vector<int> result;
    for (size_t p = 0; p < source.primitives.size(); ++p) {
        const tinygltf::Primitive& primitive = source.primitives[p];
        const std::string where = fmt::format("mesh {} primitive {}", index, p);
        if (!has_triangles(in, primitive, where)) continue;
        if (!primitive.targets.empty())
            in.warn("mesh {}: morph targets are not applied (rest pose)", index);
        Mesh mesh = read_vertices(in, primitive, where);
        mesh.name = source.name;
        mesh.triangles = read_triangles(in, primitive, mesh.positions.size(), where);
        report(in, clean_mesh(mesh), where);
        if (mesh.triangles.empty()) continue;
        mesh.material = import_material(in, primitive.material, where);
        warn_of_missing_uvs(in, mesh, where);
        result.push_back(int(in.scene.meshes.size()));
        in.scene.meshes.push_back(std::move(mesh));
    }
    return result;
}

} // namespace

const std::vector<int>& import_mesh(GltfImport& in, int index) {
    const auto known = in.meshes.find(index);
    if (known != in.meshes.end()) return known->second;
    return in.meshes[index] = imported_primitives(in, index);
}

} // namespace ql
