// Shafts: the lines through one patch on one face of a voxel and one patch on another face.
//
// Source: Keul et al. 2016 and Nilles 2017, section 5.2.4. Each of the 6 faces (-x, +x, -y, +y, -z,
// +z: 0 to 5) is cut into N x N patches, number N v + u with u along the axis after that of the
// face and v along the one after it. The 15 unordered pairs of faces are blocks of N^4 shafts, in
// lexicographic order; inside a block N^2 * (patch of the lower face) + (patch of the higher face).
// A directed shaft is twice that number, plus 1 if light enters by the higher face.
//
// One function maps a point and a direction to a shaft: deposits, measures and reads all use it.
// All in double precision; pure functions.
#pragma once

#include "linespace/grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace ql {

inline constexpr int kMaxPatches = 16; // N

// How many there are in a voxel.
constexpr uint32_t shaft_count(int patches) {
    const auto n = uint32_t(patches);
    return 15 * n * n * n * n;
}
constexpr uint32_t directed_shaft_count(int patches) {
    return 2 * shaft_count(patches);
}

// Block of a pair of faces a < b.
constexpr int block_of_faces(int a, int b) {
    return a * (9 - a) / 2 + b - 1;
}

// A directed shaft taken apart: light comes in by one patch and would leave by the other.
struct ShaftEnds {
    int entry_face, entry_patch;
    int exit_face, exit_patch;
    bool operator==(const ShaftEnds&) const = default;
};

constexpr uint32_t directed_shaft(const ShaftEnds& ends, int patches) {
    const auto n2 = uint32_t(patches * patches);
    const bool enters_low = ends.entry_face < ends.exit_face;
    const int low_face = enters_low ? ends.entry_face : ends.exit_face;
    const int high_face = enters_low ? ends.exit_face : ends.entry_face;
    const auto low = uint32_t(enters_low ? ends.entry_patch : ends.exit_patch);
    const auto high = uint32_t(enters_low ? ends.exit_patch : ends.entry_patch);
    const auto block = uint32_t(block_of_faces(low_face, high_face));
    return 2 * ((block * n2 + low) * n2 + high) + (enters_low ? 0 : 1);
}

ShaftEnds shaft_ends(uint32_t directed, int patches);

// The class of a surface's normal: its dominant axis and sign (6 classes), or 0. Keeps light on the
// two sides of a wall, or on a floor and the wall beside it, apart within a shaft. The axes have
// slightly different weights: normals halfway between two axes occur, and rounding must not decide.
template<class V>
int normal_class(const V& normal, int classes) {
    if (classes == 1) return 0;
    const double w[3] = {std::abs(double(normal.x)), std::abs(double(normal.y)) * 1.0371,
                         std::abs(double(normal.z)) * 0.9713};
    const int axis = w[0] >= w[1] && w[0] >= w[2] ? 0 : w[1] >= w[2] ? 1 : 2;
    return 2 * axis + (double(normal[axis]) < 0 ? 1 : 0);
}

// Where a line from a point towards the light lies.
struct ShaftPlace {
    uint32_t voxel;
    uint32_t shaft;          // directed
    double t_entry;          // along the direction from the point to the face where light enters
    double entry_u, entry_v; // on that face, in [0, N)
    double exit_u, exit_v;
    int entry_face, exit_face;
};

namespace detail {

// Coordinates on a face: the two axes after that of the face.
inline constexpr int kAxisU[3] = {1, 2, 0};
inline constexpr int kAxisV[3] = {2, 0, 1};

inline int patch_coordinate(double x, int patches) {
    return std::clamp(int(x), 0, patches - 1);
}

} // namespace detail

inline uint32_t shaft_of(const ShaftPlace& place, int patches) {
    const auto patch = [&](double u, double v) {
        return detail::patch_coordinate(v, patches) * patches +
               detail::patch_coordinate(u, patches);
    };
    return directed_shaft({place.entry_face, patch(place.entry_u, place.entry_v), place.exit_face,
                           patch(place.exit_u, place.exit_v)},
                          patches);
}

// point and direction (towards the light, not zero) in render space. None if the point lies outside
// of the grid, or if rounding makes the line enter and leave by the same face.
inline std::optional<ShaftPlace> locate(const VoxelGrid& grid, int patches, const V3d& point,
                                        const V3d& direction) {
    // Find the voxel and the point inside of it, in units of the voxel.
    int at[3];
    double p[3];
    for (int axis = 0; axis < 3; ++axis) {
        const double g = (point[axis] - grid.lower[axis]) / grid.cell[axis];
        if (!(g >= 0 && g < grid.counts[size_t(axis)])) return std::nullopt;
        at[axis] = int(g);
        p[axis] = g - at[axis];
    }

    // Leave the voxel on both sides; of equal distances the lowest axis counts.
    double t_forward = std::numeric_limits<double>::infinity(), t_back = t_forward;
    int axis_forward = -1, axis_back = -1;
    double d[3];
    for (int axis = 0; axis < 3; ++axis) {
        d[axis] = direction[axis] / grid.cell[axis];
        if (d[axis] == 0) continue;
        const double speed = std::abs(d[axis]);
        const double ahead = (d[axis] > 0 ? 1 - p[axis] : p[axis]) / speed;
        const double behind = (d[axis] > 0 ? p[axis] : 1 - p[axis]) / speed;
        if (ahead < t_forward) {
            t_forward = ahead;
            axis_forward = axis;
        }
        if (behind < t_back) {
            t_back = behind;
            axis_back = axis;
        }
    }
    if (axis_forward < 0) return std::nullopt;
    ShaftPlace place;
    place.voxel = grid.index(at[0], at[1], at[2]);
    place.t_entry = t_forward;
    place.entry_face = 2 * axis_forward + (d[axis_forward] > 0 ? 1 : 0);
    place.exit_face = 2 * axis_back + (d[axis_back] > 0 ? 0 : 1);
    if (place.entry_face == place.exit_face) return std::nullopt;
    const auto on_face = [&](int axis, double t) {
        return std::clamp(p[axis] + t * d[axis], 0.0, 1.0) * patches;
    };
    place.entry_u = on_face(detail::kAxisU[axis_forward], t_forward);
    place.entry_v = on_face(detail::kAxisV[axis_forward], t_forward);
    place.exit_u = on_face(detail::kAxisU[axis_back], -t_back);
    place.exit_v = on_face(detail::kAxisV[axis_back], -t_back);
    place.shaft = shaft_of(place, patches);
    return place;
}

} // namespace ql
