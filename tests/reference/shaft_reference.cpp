#include "reference/shaft_reference.h"

#include <cmath>

namespace ql::reference {

namespace {

bool holds(const V3d& lower, const V3d& upper, const V3d& p) {
    return p.x >= lower.x && p.x < upper.x && p.y >= lower.y && p.y < upper.y && p.z >= lower.z &&
           p.z < upper.z;
}

struct Crossing {
    int face;
    double t, u, v;
};

// Where the line meets the plane of a face inside the face.
std::optional<Crossing> crossing(const V3d& lower, const V3d& size, int face, const V3d& point,
                                 const V3d& direction) {
    const int axis = face / 2, ua = (axis + 1) % 3, va = (axis + 2) % 3;
    if (direction[axis] == 0) return std::nullopt;
    const double plane = lower[axis] + (face % 2 ? size[axis] : 0);
    const double t = (plane - point[axis]) / direction[axis];
    const V3d q = point + direction * t;
    const double u = (q[ua] - lower[ua]) / size[ua], v = (q[va] - lower[va]) / size[va];
    if (u < 0 || u > 1 || v < 0 || v > 1) return std::nullopt;
    return Crossing{face, t, u, v};
}

int patch_of(const Crossing& c, int patches) {
    const int u = std::min(int(std::floor(c.u * patches)), patches - 1);
    const int v = std::min(int(std::floor(c.v * patches)), patches - 1);
    return patches * v + u;
}

} // namespace

std::optional<ShaftPlace> locate(const VoxelGrid& grid, int patches, const V3d& point,
                                 const V3d& direction) {
    for (uint32_t voxel = 0; voxel < grid.size(); ++voxel) {
        const V3d lower = grid.corner(voxel);
        if (!holds(lower, lower + grid.cell, point)) continue;
        std::optional<Crossing> entry, exit;
        for (int face = 0; face < 6; ++face)
            if (const auto c = crossing(lower, grid.cell, face, point, direction))
                (c->t > 0 ? entry : exit) = c;
        if (!entry || !exit) return std::nullopt;
        ShaftPlace place{};
        place.voxel = voxel;
        place.t_entry = entry->t;
        place.shaft = directed_shaft(
            {entry->face, patch_of(*entry, patches), exit->face, patch_of(*exit, patches)},
            patches);
        return place;
    }
    return std::nullopt;
}

bool patches_touch(int patches, const ShaftEnds& ends) {
    const auto range = [&](int face, int patch, int axis) {
        if (axis == face / 2) {
            const int plane = face % 2 ? patches : 0;
            return std::pair(plane, plane);
        }
        const int low = axis == (face / 2 + 1) % 3 ? patch % patches : patch / patches;
        return std::pair(low, low + 1);
    };
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = range(ends.entry_face, ends.entry_patch, axis);
        const auto b = range(ends.exit_face, ends.exit_patch, axis);
        if (a.second < b.first || b.second < a.first) return false;
    }
    return true;
}

double etendue(const V3d& voxel, int patches, const ShaftEnds& ends) {
    constexpr int kSteps = 20;
    // Points of a patch, squeezed towards both ends by 3 s^2 - 2 s^3.
    const auto smooth = [](double s) { return s * s * (3 - 2 * s); };
    const auto slope = [](double s) { return 6 * s * (1 - s); };
    const auto point = [&](int face, int patch, double s, double t) {
        const int axis = face / 2, ua = (axis + 1) % 3, va = (axis + 2) % 3;
        V3d p;
        p[axis] = face % 2 ? voxel[axis] : 0;
        p[ua] = (patch % patches + smooth(s)) * voxel[ua] / patches;
        p[va] = (patch / patches + smooth(t)) * voxel[va] / patches;
        return p;
    };
    const auto area = [&](int face) {
        return voxel[(face / 2 + 1) % 3] * voxel[(face / 2 + 2) % 3] / (patches * patches);
    };
    double sum = 0;
    const auto at = [](int i) { return (i + 0.5) / kSteps; };
    for (int i = 0; i < kSteps; ++i)
        for (int j = 0; j < kSteps; ++j)
            for (int k = 0; k < kSteps; ++k)
                for (int l = 0; l < kSteps; ++l) {
                    const V3d way = point(ends.exit_face, ends.exit_patch, at(k), at(l)) -
                                    point(ends.entry_face, ends.entry_patch, at(i), at(j));
                    const double r2 = way.length2();
                    sum += std::abs(way[ends.entry_face / 2] * way[ends.exit_face / 2]) /
                           (r2 * r2) * slope(at(i)) * slope(at(j)) * slope(at(k)) * slope(at(l));
                }
    // By the sum of the weights, which is not quite kSteps.
    double weights = 0;
    for (int i = 0; i < kSteps; ++i)
        weights += slope(at(i));
    return sum / std::pow(weights, 4) * area(ends.entry_face) * area(ends.exit_face);
}

} // namespace ql::reference
