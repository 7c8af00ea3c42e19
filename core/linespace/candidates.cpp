#include "linespace/candidates.h"

#include "base/error.h"
#include "geometry/quadric.h"

#include <cmath>

namespace ql {

namespace {

constexpr double kSlack = 1e-6; // in units of the voxel: what touches the hull belongs to it

std::array<V3d, 4> patch_corners(int face, int patch, int patches) {
    const int axis = face / 2;
    const int ua = detail::kAxisU[axis], va = detail::kAxisV[axis];
    std::array<V3d, 4> corners;
    for (int i = 0; i < 4; ++i) {
        V3d& p = corners[size_t(i)];
        p[axis] = face % 2;
        // Around the rectangle.
        p[ua] = double(patch % patches + (i == 1 || i == 2)) / patches;
        p[va] = double(patch / patches + (i >= 2)) / patches;
    }
    return corners;
}

// The plane through three points that has all others on one side, if it has.
std::optional<HullPlane> supporting_plane(const V3d& a, const V3d& b, const V3d& c,
                                          const std::array<V3d, 8>& all) {
    V3d normal = (b - a).cross(c - a);
    const double length = normal.length();
    if (!(length > 1e-12)) return std::nullopt;
    normal /= length;
    double low = 0, high = 0;
    for (const V3d& p : all) {
        const double d = normal.dot(p - a);
        low = std::min(low, d);
        high = std::max(high, d);
    }
    constexpr double kFlat = 1e-9;
    if (high <= kFlat && low < -kFlat) return HullPlane{normal, normal.dot(a)};
    if (low >= -kFlat && high > kFlat) return HullPlane{-normal, -normal.dot(a)};
    return std::nullopt;
}

void add_plane(std::vector<HullPlane>& hull, const HullPlane& plane) {
    for (const HullPlane& known : hull)
        if ((known.normal - plane.normal).length2() < 1e-18 &&
            std::abs(known.offset - plane.offset) < 1e-9)
            return;
    hull.push_back(plane);
}

V3d to_voxel(const VoxelGrid& grid, const V3d& lower, const V3f& p) {
    const V3d q = V3d(p) - lower;
    return {q.x / grid.cell.x, q.y / grid.cell.y, q.z / grid.cell.z};
}

// Moeller-Trumbore in double precision.
bool hit_triangle(const World& world, const Ray& ray, const Primitive& primitive, Hit& hit) {
    const auto corners = triangle_corners(world, primitive.surface, primitive.triangle);
    const V3d p0(corners[0]), e1 = V3d(corners[1]) - p0, e2 = V3d(corners[2]) - p0;
    const V3d d(ray.direction), s = V3d(ray.origin) - p0;
    const V3d p = d.cross(e2);
    const double determinant = e1.dot(p);
    if (determinant == 0) return false;
    const double u = s.dot(p) / determinant;
    if (u < 0 || u > 1) return false;
    const V3d q = s.cross(e1);
    const double v = d.dot(q) / determinant;
    if (v < 0 || u + v > 1) return false;
    const double t = e2.dot(q) / determinant;
    if (!(t > 0 && t <= double(hit.t))) return false;
    const Surface& surface = world.surfaces[primitive.surface];
    V3d normal = e1.cross(e2);
    // Instanced bodies give their normal in their own space, as Embree does.
    if (surface.instanced) {
        const auto& triangle =
            world.scene->meshes[size_t(surface.mesh)].triangles[primitive.triangle];
        const auto& positions = surface.body->positions;
        normal = V3d(positions[triangle[1]] - positions[triangle[0]])
                     .cross(V3d(positions[triangle[2]] - positions[triangle[0]]));
    }
    hit = {float(t), float(u), float(v), primitive.surface, primitive.triangle, V3f(normal)};
    return true;
}

bool hit_shape(const World& world, const Ray& ray, const Primitive& primitive, Hit& hit) {
    const Surface& surface = world.surfaces[primitive.surface];
    const auto found =
        intersect_shape(*surface.implicit, surface.body_from_render.point(V3d(ray.origin)),
                        surface.body_from_render.vector(V3d(ray.direction)), 0, double(hit.t));
    if (!found) return false;
    hit = {float(found->t),
           found->uv.x,
           found->uv.y,
           primitive.surface,
           0,
           detail::transformed(surface.render_from_normal, V3f(found->normal))};
    return true;
}

} // namespace

std::vector<HullPlane> shaft_hull(const ShaftEnds& ends, int patches) {
    const auto a = patch_corners(ends.entry_face, ends.entry_patch, patches);
    const auto b = patch_corners(ends.exit_face, ends.exit_patch, patches);
    std::array<V3d, 8> all;
    for (size_t i = 0; i < 4; ++i) {
        all[i] = a[i];
        all[i + 4] = b[i];
    }
    std::vector<HullPlane> hull;
    for (const auto* patch : {&a, &b})
        if (const auto plane = supporting_plane((*patch)[0], (*patch)[1], (*patch)[2], all))
            add_plane(hull, *plane);
    // Sides hold an edge of one patch and a corner of the other.
    for (size_t i = 0; i < 4; ++i)
        for (size_t k = 0; k < 4; ++k) {
            if (const auto plane = supporting_plane(a[i], a[(i + 1) % 4], b[k], all))
                add_plane(hull, *plane);
            if (const auto plane = supporting_plane(b[i], b[(i + 1) % 4], a[k], all))
                add_plane(hull, *plane);
        }
    return hull;
}

// Sutherland & Hodgman, "Reentrant polygon clipping", CACM 17 (1974).
bool overlaps_hull(const std::vector<HullPlane>& hull, const std::array<V3d, 3>& triangle) {
    std::vector<V3d> polygon(triangle.begin(), triangle.end()), clipped;
    for (const HullPlane& plane : hull) {
        clipped.clear();
        for (size_t i = 0; i < polygon.size(); ++i) {
            const V3d &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
            const double dp = plane.normal.dot(p) - plane.offset - kSlack;
            const double dq = plane.normal.dot(q) - plane.offset - kSlack;
            if (dp <= 0) clipped.push_back(p);
            if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0))
                clipped.push_back(p + (q - p) * (dp / (dp - dq)));
        }
        polygon.swap(clipped);
        if (polygon.empty()) return false;
    }
    return true;
}

ShaftCandidates::ShaftCandidates(const World& world, const ReadTable& table, const Workers& workers)
    : m_world(world), m_table(table),
      m_voxels(world, table.grid(), std::vector<char>(table.grid().size(), 1), workers) {
    for (const Material& material : world.scene->materials)
        if (material.alpha_mode != AlphaMode::opaque)
            throw usage_error("--occlusion candidates knows no alpha, which material '{}' has",
                              material.name);
    const VoxelGrid& grid = table.grid();
    const int patches = table.patches();
    const uint32_t directed = table.directed_shafts();
    std::vector<std::vector<HullPlane>> hulls(directed / 2);
    workers.for_each(hulls.size(), [&](size_t i) {
        hulls[i] = shaft_hull(shaft_ends(uint32_t(2 * i), patches), patches);
    });

    // Clip every primitive of a voxel against every shaft with light; the lists of a voxel lie
    // together, so that counting, adding up and filling go voxel by voxel.
    const size_t voxels = grid.size();
    std::vector<std::vector<Primitive>> lists(voxels);
    std::vector<std::vector<uint32_t>> counts(voxels);
    workers.for_each(voxels, [&](size_t n) {
        const auto voxel = uint32_t(n);
        const V3d lower = grid.corner(voxel);
        const auto shafts = table.shafts_of(voxel);
        counts[n].resize(shafts.size(), 0);
        std::vector<std::array<V3d, 3>> triangles;
        for (const Primitive& p : m_voxels.of(voxel)) {
            std::array<V3d, 3> corners = {V3d(0), V3d(0), V3d(0)};
            if (world.surfaces[p.surface].kind == Surface::Kind::triangles) {
                const auto found = triangle_corners(world, p.surface, p.triangle);
                for (size_t i = 0; i < 3; ++i)
                    corners[i] = to_voxel(grid, lower, found[i]);
            }
            triangles.push_back(corners);
        }
        for (size_t s = 0; s < shafts.size() && shafts[s] < table.caustics_from(); ++s)
            for (size_t i = 0; i < triangles.size(); ++i) {
                const Primitive& p = m_voxels.of(voxel)[i];
                if (world.surfaces[p.surface].kind == Surface::Kind::triangles &&
                    !overlaps_hull(hulls[shafts[s] % directed / 2], triangles[i]))
                    continue;
                lists[n].push_back(p);
                ++counts[n][s];
            }
    });
    m_first.push_back(0);
    for (size_t n = 0; n < voxels; ++n) {
        for (const uint32_t count : counts[n])
            m_first.push_back(m_first.back() + count);
        m_items.insert(m_items.end(), lists[n].begin(), lists[n].end());
        lists[n] = {};
    }
}

bool ShaftCandidates::intersect(const Ray& ray, uint32_t voxel, uint32_t number, Hit& hit) const {
    const auto entry = m_table.find(voxel, number);
    const std::span<const Primitive> list =
        entry ? std::span(m_items).subspan(m_first[*entry], m_first[*entry + 1] - m_first[*entry])
              : m_voxels.of(voxel);
    hit.t = ray.t_far;
    bool found = false;
    for (const Primitive& primitive : list)
        found |= m_world.surfaces[primitive.surface].kind == Surface::Kind::triangles
                     ? hit_triangle(m_world, ray, primitive, hit)
                     : hit_shape(m_world, ray, primitive, hit);
    return found;
}

} // namespace ql
