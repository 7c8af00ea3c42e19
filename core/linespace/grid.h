// The uniform grid of voxels over a scene, in render space.
//
// Source: Nilles 2017, section 2.1 (after Fujimoto et al. 1986). The scene's bounds are padded by
// an irrational part of a cell on either side, so that walls along the axes never lie on the faces
// of voxels. Immutable, hence safe to share between threads.
#pragma once

#include "geometry/world.h"

#include <array>
#include <cstdint>

namespace ql {

inline constexpr int kMaxVoxelsPerSide = 1 << 14;
inline constexpr uint64_t kMaxVoxels = uint64_t{1} << 28;

struct GridConfig {
    std::array<int, 3> voxels = {0, 0, 0}; // counts along x, y, z; 0: from voxel_size
    double voxel_size = 0;                 // metres; 0: 1/32 of the longest side of the scene
};

struct VoxelGrid {
    V3d lower = {0, 0, 0}; // render space
    V3d cell = {1, 1, 1};  // size of a voxel
    std::array<int, 3> counts = {1, 1, 1};

    uint64_t size() const {
        return uint64_t(counts[0]) * uint64_t(counts[1]) * uint64_t(counts[2]);
    }
    V3d upper() const {
        return lower + V3d(cell.x * counts[0], cell.y * counts[1], cell.z * counts[2]);
    }
    // x runs fastest, then y, then z: the order of the pixels of the cache file.
    uint32_t index(int x, int y, int z) const {
        return uint32_t((uint64_t(z) * uint64_t(counts[1]) + uint64_t(y)) * uint64_t(counts[0]) +
                        uint64_t(x));
    }
    std::array<int, 3> coordinates(uint32_t voxel) const {
        const auto nx = uint32_t(counts[0]), ny = uint32_t(counts[1]);
        return {int(voxel % nx), int(voxel / nx % ny), int(voxel / nx / ny)};
    }
    V3d corner(uint32_t voxel) const {
        const auto at = coordinates(voxel);
        return lower + V3d(cell.x * at[0], cell.y * at[1], cell.z * at[2]);
    }
};

// Errors: ErrorKind::usage for counts or a size out of range.
VoxelGrid grid_over(const World& world, const GridConfig& config);

} // namespace ql
