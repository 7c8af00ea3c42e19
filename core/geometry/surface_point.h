// What a hit says about the surface: position, normals, texture coordinates, ray offset.
//
// Positions come from the corners of the triangle, not from the ray's length: their error does not
// grow with the distance that the ray has come.
#pragma once

#include "geometry/world.h"

#include <algorithm>
#include <cmath>

namespace ql {

struct SurfacePoint {
    V3f position = {0, 0, 0}; // render space
    V3f ng = {0, 0, 1};       // unit geometric normal on the front side
    V3f ns = {0, 0, 1};       // unit shading normal, on the side of ng
    float offset = 0;         // how far rays start off the surface, see offset_origin
    uint32_t surface = 0;
    uint32_t primitive = 0;
    int material = 0;
    V2f uv[2] = {{0, 0}, {0, 0}};
    V4f color = {1, 1, 1, 1};
    V4f tangent = {0, 0, 0, 1}; // of materials with a normal texture; xyz zero where there is none
};

namespace detail {

inline V3f transformed(const Imath::M33f& m, const V3f& v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
}

inline float largest_coordinate(const V3f& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

template<class T>
T interpolated(const std::vector<T>& values, const std::array<uint32_t, 3>& triangle, float u,
               float v) {
    return values[triangle[0]] * (1 - u - v) + values[triangle[1]] * u + values[triangle[2]] * v;
}

// Positions on an edge may by rounding lie behind the surface that meets there, and rays from them
// would leave a closed room: keep as far off each edge as rays start off the surface. Edges are in
// render space, twice_area is the length of their cross product.
inline void move_off_edges(const V3f& edge1, const V3f& edge2, float twice_area, float offset,
                           Hit& hit) {
    const float least = offset / twice_area;
    constexpr float kThird = 1.0f / 3;
    const float b0 =
        std::max(1 - hit.u - hit.v, std::min(kThird, least * (edge2 - edge1).length()));
    const float b1 = std::max(hit.u, std::min(kThird, least * edge2.length()));
    const float b2 = std::max(hit.v, std::min(kThird, least * edge1.length()));
    const float scale = 1 / (b0 + b1 + b2);
    hit.u = b1 * scale;
    hit.v = b2 * scale;
}

// Whether a hit is so close to an edge that this could matter; on the safe side.
inline bool is_near_edge(const V3f& edge1, const V3f& edge2, float twice_area, float offset,
                         const Hit& hit) {
    const float reach = std::abs(edge1.x) + std::abs(edge1.y) + std::abs(edge1.z) +
                        std::abs(edge2.x) + std::abs(edge2.y) + std::abs(edge2.z);
    return !(std::min({hit.u, hit.v, 1 - hit.u - hit.v}) * twice_area > offset * reach);
}

inline void add_shading_normal(const Surface& surface, const Mesh& mesh,
                               const std::array<uint32_t, 3>& triangle, const Hit& hit,
                               SurfacePoint& point) {
    if (mesh.normals.empty()) return;
    const V3f n =
        transformed(surface.render_from_normal, interpolated(mesh.normals, triangle, hit.u, hit.v));
    const float length = n.length();
    if (!(length > 1e-6f)) return;
    // On the side of the geometric normal: files with either winding give the same surface.
    point.ns = n * ((n.dot(point.ng) < 0 ? -1.0f : 1.0f) / length);
}

// Where the file has no tangents: the direction in which u of this set grows on this triangle.
inline void add_derived_tangent(const Surface& surface, const Mesh& mesh,
                                const std::array<uint32_t, 3>& triangle, size_t set,
                                SurfacePoint& point) {
    const std::vector<V2f>& uvs = mesh.uvs[set];
    if (uvs.empty()) return;
    const V3f e1 = mesh.positions[triangle[1]] - mesh.positions[triangle[0]];
    const V3f e2 = mesh.positions[triangle[2]] - mesh.positions[triangle[0]];
    const V2f d1 = uvs[triangle[1]] - uvs[triangle[0]];
    const V2f d2 = uvs[triangle[2]] - uvs[triangle[0]];
    const float determinant = d1.x * d2.y - d1.y * d2.x;
    const float sign = determinant < 0 ? -1.0f : 1.0f;
    V3f direction = transformed(surface.render_from_tangent, (e1 * d2.y - e2 * d1.y) * sign);
    const float length = direction.length();
    if (!(length > 0) || !std::isfinite(length)) return;
    direction /= length;
    // glTF's bitangent runs against v, which grows downwards.
    point.tangent = V4f(direction.x, direction.y, direction.z, -sign * surface.winding);
}

inline void add_texture_coordinates(const Mesh& mesh, const std::array<uint32_t, 3>& triangle,
                                    const Hit& hit, SurfacePoint& point) {
    for (size_t set = 0; set < 2; ++set)
        if (!mesh.uvs[set].empty())
            point.uv[set] = interpolated(mesh.uvs[set], triangle, hit.u, hit.v);
    if (!mesh.colors.empty()) point.color = interpolated(mesh.colors, triangle, hit.u, hit.v);
}

// set: of the coordinates of the normal texture.
inline void add_tangent(const Surface& surface, const Mesh& mesh,
                        const std::array<uint32_t, 3>& triangle, const Hit& hit, size_t set,
                        SurfacePoint& point) {
    if (mesh.tangents.empty()) {
        add_derived_tangent(surface, mesh, triangle, set, point);
        return;
    }
    const V4f t = interpolated(mesh.tangents, triangle, hit.u, hit.v);
    const V3f direction = transformed(surface.render_from_tangent, V3f(t.x, t.y, t.z));
    point.tangent =
        V4f(direction.x, direction.y, direction.z, (t.w < 0 ? -1.0f : 1.0f) * surface.winding);
}

// The same at the rims of a cone.
void move_off_rim(const Surface& surface, SurfacePoint& point);

// Moves the hit off the edges.
inline void fill_triangle(const World& world, const Surface& surface, Hit& hit,
                          SurfacePoint& point) {
    const Mesh& mesh = world.scene->meshes[size_t(surface.mesh)];
    const auto& triangle = mesh.triangles[hit.primitive];
    const std::vector<V3f>& positions = surface.body->positions;
    const V3f &p0 = positions[triangle[0]], &p1 = positions[triangle[1]],
              &p2 = positions[triangle[2]];
    const V3f edge1 = p1 - p0, edge2 = p2 - p0;
    const float twice_area = hit.ng.length();
    const auto at = [&] { return p0 * (1 - hit.u - hit.v) + p1 * hit.u + p2 * hit.v; };
    if (!surface.instanced) {
        point.offset = kOffsetFactor * std::max({largest_coordinate(p0), largest_coordinate(p1),
                                                 largest_coordinate(p2)});
        if (is_near_edge(edge1, edge2, twice_area, point.offset, hit)) [[unlikely]]
            move_off_edges(edge1, edge2, twice_area, point.offset, hit);
        point.position = at();
        point.ng = hit.ng * (surface.winding / twice_area);
    } else {
        point.offset = surface.offset;
        if (is_near_edge(edge1, edge2, twice_area, point.offset * surface.body_per_render, hit))
            [[unlikely]] {
            const V3d e1 = surface.render_from_body.vector(V3d(edge1));
            const V3d e2 = surface.render_from_body.vector(V3d(edge2));
            move_off_edges(V3f(e1), V3f(e2), float(e1.cross(e2).length()), point.offset, hit);
        }
        point.position = V3f(surface.render_from_body.point(V3d(at())));
        point.ng = transformed(surface.render_from_normal, hit.ng).normalized();
    }
    point.ns = point.ng;
}

inline SurfacePoint point_of(const World& world, const Ray& ray, Hit& hit) {
    SurfacePoint point;
    const Surface& surface = world.surfaces[hit.surface];
    point.surface = hit.surface;
    point.primitive = hit.primitive;
    point.material = surface.material;
    if (surface.kind == Surface::Kind::triangles) [[likely]] {
        fill_triangle(world, surface, hit, point);
        return point;
    }
    point.position = ray.origin + ray.direction * hit.t;
    point.ng = hit.ng.normalized();
    point.ns = point.ng;
    // The position follows the ray: its error also grows with the way the ray has come.
    point.offset = surface.offset + 2 * kOffsetFactor * hit.t * ray.direction.length();
    if (surface.kind == Surface::Kind::cone) move_off_rim(surface, point);
    return point;
}

} // namespace detail

// Position, geometric normal and offset alone; the rest of a SurfacePoint is as by default.
inline SurfacePoint geometric_point(const World& world, const Ray& ray, Hit hit) {
    return detail::point_of(world, ray, hit);
}

inline SurfacePoint surface_point(const World& world, const Ray& ray, Hit hit) {
    SurfacePoint point = detail::point_of(world, ray, hit);
    const Surface& surface = world.surfaces[hit.surface];
    if (surface.kind != Surface::Kind::triangles) {
        point.uv[0] = point.uv[1] = V2f(hit.u, hit.v);
        return point;
    }
    const Mesh& mesh = world.scene->meshes[size_t(surface.mesh)];
    const auto& triangle = mesh.triangles[hit.primitive];
    detail::add_shading_normal(surface, mesh, triangle, hit, point);
    detail::add_texture_coordinates(mesh, triangle, hit, point);
    const TextureUse& normals = world.scene->materials[size_t(point.material)].normal_texture;
    if (normals.used())
        detail::add_tangent(surface, mesh, triangle, hit, size_t(normals.uv_set), point);
    return point;
}

} // namespace ql
