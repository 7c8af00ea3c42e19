#include "linespace/grid.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ql {

namespace {

// Shares of a cell between the scene and the first and the last face: irrational, and the sum too.
// At 0.38 and 0.41 walls at the bounds cut the patches of N = 4 in their middle; walls that leave
// slivers of patches make shafts whose tiny share is hard to measure.
constexpr double kPadBelow = 2 - std::numbers::phi;
constexpr double kPadAbove = std::numbers::sqrt2 - 1;
constexpr double kPads = kPadBelow + kPadAbove;
// A scene without extent along an axis still gets cells, of this share of its longest side.
constexpr double kLeastExtent = 1e-4;
constexpr double kDefaultVoxelsPerSide = 32;

int count_for(double extent, double cell) {
    const double count = std::ceil(extent / cell + kPads);
    if (!(count <= kMaxVoxelsPerSide))
        throw usage_error("a voxel size that makes {:.0f} voxels on a side, expected at most {}",
                          count, kMaxVoxelsPerSide);
    return std::max(1, int(count));
}

} // namespace

VoxelGrid grid_over(const World& world, const GridConfig& config) {
    V3d extent = world.bounds.isEmpty() ? V3d(1, 1, 1) : world.bounds.size();
    const V3d below = world.bounds.isEmpty() ? V3d(0, 0, 0) : world.bounds.min;
    const double longest = std::max({extent.x, extent.y, extent.z, 1e-30});
    for (int axis = 0; axis < 3; ++axis)
        extent[axis] = std::max(extent[axis], longest * kLeastExtent);

    // Cells of a given size are cubes; given counts divide the bounds.
    VoxelGrid grid;
    const bool by_count = config.voxels[0] > 0;
    const double size = config.voxel_size > 0 ? config.voxel_size * world.space.scale
                                              : longest / kDefaultVoxelsPerSide;
    for (int axis = 0; axis < 3; ++axis) {
        int& count = grid.counts[size_t(axis)];
        count = by_count ? config.voxels[size_t(axis)] : count_for(extent[axis], size);
        if (count < 1 || count > kMaxVoxelsPerSide)
            throw usage_error("{} voxels along an axis, expected 1 to {}", count,
                              kMaxVoxelsPerSide);
        grid.cell[axis] = by_count ? extent[axis] / (count - kPads) : size;
        grid.lower[axis] = below[axis] - kPadBelow * grid.cell[axis];
    }
    if (grid.size() > kMaxVoxels)
        throw usage_error("a grid of {} voxels, expected at most {}", grid.size(), kMaxVoxels);
    return grid;
}

} // namespace ql
