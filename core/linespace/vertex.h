// What vertices of light paths and camera paths are to the cache.
#pragma once

#include "render/path_kernel.h"

namespace ql {

// Where rays into the half space of w start, in double precision: also the point that is looked up
// in the grid, so that walls belong to the voxel on the side that is lit.
inline V3d start_of(const PathVertex& vertex, const V3f& w) {
    return V3d(offset_origin(vertex.position, vertex.ng, vertex.offset, w));
}

// Whether points of this material ever take light from the cache; perfect mirrors and glass do not.
inline bool takes_light(const Material& material) {
    return (lobes_of(material) & (kLobeDiffuse | kLobePhong)) != 0;
}

} // namespace ql
