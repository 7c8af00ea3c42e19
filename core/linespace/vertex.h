// What vertices of light paths and camera paths are to the cache.
#pragma once

#include "render/path_kernel.h"

#include <algorithm>
#include <cmath>

namespace ql {

// Where rays into the half space of w start, in double precision: also the point that is looked up
// in the grid, so that walls belong to the voxel on the side that is lit.
inline V3d start_of(const PathVertex& vertex, const V3f& w) {
    return V3d(offset_origin(vertex.position, vertex.ng, vertex.offset, w));
}

// Point i of n of a lattice in [0, 1)^2, rotated: Korobov points of the golden ratio. shift in
// [0, 1)^2.
inline V2f rotated_lattice(const V2f& shift, uint32_t i, uint32_t n) {
    const auto wrapped = [](float x) { return x < 1 ? x : std::min(x - 1, 0x1.fffffep-1f); };
    const float golden = float(i) * 0.618034f;
    return {wrapped(shift.x + float(i) / float(n)),
            wrapped(shift.y + (golden - std::floor(golden)))};
}

// Whether points of this material ever take light from the cache; perfect mirrors and glass do not.
inline bool takes_light(const Material& material) {
    return (lobes_of(material) & (kLobeDiffuse | kLobePhong)) != 0;
}

} // namespace ql
