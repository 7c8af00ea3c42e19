// Slow twins of the shaft functions: face by face, and integration by points.
#pragma once

#include "linespace/shaft.h"

namespace ql::reference {

// Intersects the line with all six faces of every voxel that may hold the point.
std::optional<ShaftPlace> locate(const VoxelGrid& grid, int patches, const V3d& point,
                                 const V3d& direction);

// Whether two patches share at least a corner.
bool patches_touch(int patches, const ShaftEnds& ends);

// Midpoint rule with points that gather where patches touch.
double etendue(const V3d& voxel, int patches, const ShaftEnds& ends);

} // namespace ql::reference
