#include "scene/mesh_cleaning.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ql {

namespace {

using Triangle = std::array<uint32_t, 3>;

template<class Vector>
bool is_finite(const Vector& v) {
    for (unsigned c = 0; c < Vector::dimensions(); ++c)
        if (!std::isfinite(v[int(c)])) return false;
    return true;
}

// Twice the area times the normal. Differences and products of floats are exact or nearly so in
// double, so that this is zero for triangles that are truly flat and for no others.
V3d area_normal(const Mesh& mesh, const Triangle& t) {
    const V3d a(mesh.positions[t[0]]);
    const V3d b(mesh.positions[t[1]]);
    const V3d c(mesh.positions[t[2]]);
    return (b - a).cross(c - a);
}

void drop_broken_triangles(Mesh& mesh, MeshCleaning& cleaning) {
    for (const V3f& p : mesh.positions)
        if (!is_finite(p)) ++cleaning.non_finite_vertices;
    std::erase_if(mesh.triangles, [&](const Triangle& t) {
        for (const uint32_t vertex : t)
            if (!is_finite(mesh.positions[vertex])) return true;
        const bool flat = area_normal(mesh, t) == V3d(0);
        if (flat) ++cleaning.degenerate_triangles;
        return flat;
    });
}

template<class T>
void keep(std::vector<T>& values, const std::vector<uint32_t>& kept) {
    if (values.empty()) return;
    for (size_t i = 0; i < kept.size(); ++i) // kept is ascending: never read after overwriting
        values[i] = values[kept[i]];
    values.resize(kept.size());
}

void drop_unused_vertices(Mesh& mesh) {
    constexpr uint32_t kUnused = std::numeric_limits<uint32_t>::max();
    std::vector<uint32_t> new_index(mesh.positions.size(), kUnused);
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t vertex : t)
            new_index[vertex] = 0;
    std::vector<uint32_t> kept;
    for (size_t i = 0; i < new_index.size(); ++i)
        if (new_index[i] != kUnused) {
            new_index[i] = uint32_t(kept.size());
            kept.push_back(uint32_t(i));
        }
    if (kept.size() == mesh.positions.size()) return;
    for (Triangle& t : mesh.triangles)
        for (uint32_t& vertex : t)
            vertex = new_index[vertex];
    keep(mesh.positions, kept);
    keep(mesh.normals, kept);
    keep(mesh.tangents, kept);
    keep(mesh.uvs[0], kept);
    keep(mesh.uvs[1], kept);
    keep(mesh.colors, kept);
}

void clean_normals(Mesh& mesh, MeshCleaning& cleaning) {
    std::vector<uint32_t> zero;
    for (size_t i = 0; i < mesh.normals.size(); ++i) {
        const V3d normal(mesh.normals[i]);
        const double length = normal.length();
        if (length > 0 && std::isfinite(length))
            mesh.normals[i] = V3f(normal / length);
        else
            zero.push_back(uint32_t(i));
    }
    cleaning.broken_attributes += zero.size();
    if (zero.empty()) return;
    std::vector<V3d> around(mesh.positions.size(), V3d(0));
    for (const Triangle& t : mesh.triangles)
        for (const uint32_t vertex : t)
            around[vertex] += area_normal(mesh, t);
    for (const uint32_t i : zero) {
        const double length = around[i].length();
        mesh.normals[i] = length > 0 ? V3f(around[i] / length) : V3f(0, 0, 1);
    }
}

void clean_tangents(Mesh& mesh, MeshCleaning& cleaning) {
    for (V4f& tangent : mesh.tangents) {
        const V3d direction(tangent.x, tangent.y, tangent.z);
        const double length = direction.length();
        if (!(length > 0) || !is_finite(tangent)) {
            ++cleaning.broken_attributes;
            mesh.tangents.clear();
            return;
        }
        const V3f unit(direction / length);
        tangent = V4f(unit.x, unit.y, unit.z, tangent.w < 0 ? -1.0f : 1.0f);
    }
}

void clean_uvs_and_colors(Mesh& mesh, MeshCleaning& cleaning) {
    for (std::vector<V2f>& uvs : mesh.uvs)
        for (V2f& uv : uvs)
            if (!is_finite(uv)) {
                ++cleaning.broken_attributes;
                uv = V2f(0);
            }
    for (V4f& color : mesh.colors) {
        const V4f before = color;
        for (int c = 0; c < 4; ++c)
            color[c] = std::isfinite(color[c]) ? std::clamp(color[c], 0.0f, 1.0f) : 0.0f;
        if (!(color == before)) ++cleaning.broken_attributes;
    }
}

} // namespace

MeshCleaning clean_mesh(Mesh& mesh) {
    MeshCleaning cleaning;
    drop_broken_triangles(mesh, cleaning);
    drop_unused_vertices(mesh);
    clean_normals(mesh, cleaning);
    clean_tangents(mesh, cleaning);
    clean_uvs_and_colors(mesh, cleaning);
    return cleaning;
}

} // namespace ql
