#include "linespace/voxel_primitives.h"

#include "geometry/quadric.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace ql {

namespace {

// Positions are floats of about 1: the box grows by more than their error.
constexpr double kMargin = 1e-6;

struct VoxelBox {
    std::array<int, 3> low, high; // inclusive
};

// Voxels that a box in render space may touch.
VoxelBox voxels_of(const VoxelGrid& grid, const V3d& low, const V3d& high) {
    VoxelBox box;
    for (int axis = 0; axis < 3; ++axis) {
        const int last = grid.counts[size_t(axis)] - 1;
        const auto cell = [&](double x) {
            const double g = std::floor((x - grid.lower[axis]) / grid.cell[axis]);
            return int(std::clamp(g, 0.0, double(last)));
        };
        box.low[size_t(axis)] = cell(low[axis] - kMargin);
        box.high[size_t(axis)] = cell(high[axis] + kMargin);
    }
    return box;
}

std::array<V3d, 3> corners_of(const World& world, uint32_t surface, uint32_t triangle) {
    const auto corners = triangle_corners(world, surface, triangle);
    return {V3d(corners[0]), V3d(corners[1]), V3d(corners[2])};
}

// Calls visit(voxel) for every voxel that holds a part of the primitive.
template<class Visit>
void visit_voxels(const World& world, const VoxelGrid& grid, const Primitive& primitive,
                  const Visit& visit) {
    const Surface& surface = world.surfaces[primitive.surface];
    std::array<V3d, 3> corners = {V3d(0), V3d(0), V3d(0)};
    Imath::Box3d bounds;
    const bool is_triangle = surface.kind == Surface::Kind::triangles;
    if (is_triangle) {
        corners = corners_of(world, primitive.surface, primitive.triangle);
        for (const V3d& corner : corners)
            bounds.extendBy(corner);
    } else {
        const V3d h = half_extent(*surface.implicit);
        for (int i = 0; i < 8; ++i)
            bounds.extendBy(surface.render_from_body.point(
                {i & 1 ? h.x : -h.x, i & 2 ? h.y : -h.y, i & 4 ? h.z : -h.z}));
    }
    const VoxelBox box = voxels_of(grid, bounds.min, bounds.max);
    for (int z = box.low[2]; z <= box.high[2]; ++z)
        for (int y = box.low[1]; y <= box.high[1]; ++y)
            for (int x = box.low[0]; x <= box.high[0]; ++x) {
                const uint32_t voxel = grid.index(x, y, z);
                const V3d lower = grid.corner(voxel) - V3d(kMargin);
                if (!is_triangle ||
                    overlaps_box({corners[0] - lower, corners[1] - lower, corners[2] - lower},
                                 grid.cell + V3d(2 * kMargin)))
                    visit(voxel);
            }
}

std::vector<Primitive> all_primitives(const World& world) {
    std::vector<Primitive> all;
    for (uint32_t s = 0; s < world.surfaces.size(); ++s) {
        const Surface& surface = world.surfaces[s];
        const size_t count = surface.kind == Surface::Kind::triangles
                                 ? world.scene->meshes[size_t(surface.mesh)].triangles.size()
                                 : 1;
        for (uint32_t t = 0; t < count; ++t)
            all.push_back({s, t});
    }
    return all;
}

} // namespace

bool overlaps_box(const std::array<V3d, 3>& corners, const V3d& size) {
    const V3d half = size * 0.5;
    const std::array<V3d, 3> v = {corners[0] - half, corners[1] - half, corners[2] - half};
    const std::array<V3d, 3> edges = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
    const auto separates = [&](const V3d& axis) {
        const double p0 = axis.dot(v[0]), p1 = axis.dot(v[1]), p2 = axis.dot(v[2]);
        const double reach =
            half.x * std::abs(axis.x) + half.y * std::abs(axis.y) + half.z * std::abs(axis.z);
        return std::min({p0, p1, p2}) > reach || std::max({p0, p1, p2}) < -reach;
    };
    for (int axis = 0; axis < 3; ++axis) {
        V3d unit(0);
        unit[axis] = 1;
        if (separates(unit)) return false;
        for (const V3d& edge : edges)
            if (separates(unit.cross(edge))) return false;
    }
    return !separates(edges[0].cross(edges[1]));
}

VoxelPrimitives::VoxelPrimitives(const World& world, const VoxelGrid& grid,
                                 const std::vector<char>& wanted, const Workers& workers) {
    const std::vector<Primitive> all = all_primitives(world);
    const size_t voxels = grid.size();

    // Count, add up, fill.
    std::vector<std::atomic<uint32_t>> counts(voxels);
    workers.for_each(all.size(), [&](size_t i) {
        visit_voxels(world, grid, all[i], [&](uint32_t voxel) {
            if (wanted[voxel]) counts[voxel].fetch_add(1, std::memory_order_relaxed);
        });
    });
    m_first.resize(voxels + 1, 0);
    for (size_t v = 0; v < voxels; ++v)
        m_first[v + 1] = m_first[v] + counts[v].load();
    m_items.resize(m_first.back());
    workers.for_each(all.size(), [&](size_t i) {
        visit_voxels(world, grid, all[i], [&](uint32_t voxel) {
            if (wanted[voxel])
                m_items[m_first[voxel] + counts[voxel].fetch_sub(1, std::memory_order_relaxed) -
                        1] = all[i];
        });
    });
    workers.for_each(voxels, [&](size_t v) {
        std::sort(m_items.begin() + int64_t(m_first[v]), m_items.begin() + int64_t(m_first[v + 1]));
    });
}

} // namespace ql
