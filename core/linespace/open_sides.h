// Which sides of the surfaces light can reach at all.
//
// Scenes are full of surfaces that nobody ever sees: undersides of columns that stand on a floor,
// insides of walls. Their share of a voxel's lines is no part of the light that arrives there, and
// would make everything beside them too dark. A line is closed if it comes from the side of a
// surface that no light reaches: from inside a body. Which sides those are is found by random walks
// from the lights that scatter evenly and never lose anything, the same for every run; a side that
// is met by less than a hundredth of the walks that meet the surface is closed, whatever the file
// says of it. A function of the scene alone; immutable, hence safe to share between threads.
#pragma once

#include "geometry/embree_scene.h"
#include "shading/light_emission.h"

#include <vector>

namespace ql {

class OpenSides {
  public:
    // rays must outlive it.
    OpenSides(const EmbreeScene& rays, const LightEmission& emission, const Workers& workers);

    // front: the side of the geometric normal.
    bool is_open(uint32_t surface, bool front) const {
        return m_is_open[2 * size_t(surface) + (front ? 0 : 1)] != 0;
    }
    // Whether light can come to a point from the far side of the ray: it leaves the scene, or ends
    // on an open side.
    bool leads_out(const V3d& point, const V3d& direction) const;

    size_t closed_count() const; // sides

  private:
    const EmbreeScene& m_rays;
    std::vector<char> m_is_open; // by surface: front, back
    bool m_all_open = true;
};

} // namespace ql
