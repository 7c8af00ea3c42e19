// Points that light has reached, and whether others can be lit from them.
//
// A point that sees one of them is reached by light, too. Which ones are asked follows from the
// point's position alone: some near it, then some of all. One that sees none of those is taken for
// hidden; so may be a point in a narrow gap, to which little light comes. Immutable, hence safe to
// share between threads.
#pragma once

#include "geometry/embree_scene.h"

#include <cstdint>
#include <vector>

namespace ql {

struct LitPoint {
    V3f position; // render space
    V3f normal;   // unit, on the side that light has come to
    float offset; // of rays that start there, see offset_origin
};

class LitPoints {
  public:
    // rays must outlive it.
    LitPoints(const EmbreeScene& rays, std::vector<LitPoint> points);

    // Whether any of the points that are asked is seen from this one.
    bool any_seen_from(const LitPoint& point) const;

  private:
    size_t cell_of(const V3f& position) const;
    bool sees(const LitPoint& a, const LitPoint& b, int& rays_left) const;

    const EmbreeScene& m_rays;
    std::vector<LitPoint> m_points; // by cell
    std::vector<uint32_t> m_first;  // point of each cell of a grid over all points
    V3f m_lower = V3f(0);
    float m_cells_per_unit = 1;
};

} // namespace ql
