// Which sides of the surfaces light can reach at all.
//
// Scenes are full of surfaces that nobody ever sees: undersides of columns that stand on a floor,
// insides of walls, walls behind a relief. Their share of a voxel's lines is no part of the light
// that arrives there, and would make everything beside them too dark. A line is closed if it comes
// from a place that no light reaches. Which those are is found by random walks from the lights that
// scatter evenly and never lose anything, the same for every run. A side that is met by less than a
// hundredth of the walks that meet the surface is closed, whatever the file says of it; of
// surfaces that few walks meet, a side all of whose points are hidden from what the walks have met
// (lit_points.h). Where a part of a side is hidden, lines are asked one by one. A function of the
// scene alone; immutable, hence safe to share between threads.
#pragma once

#include "linespace/lit_points.h"
#include "shading/light_emission.h"

#include <optional>
#include <vector>

namespace ql {

class OpenSides {
  public:
    // rays must outlive it.
    OpenSides(const EmbreeScene& rays, const LightEmission& emission, const Workers& workers);

    // Whether light reaches any of it. front: the side of the geometric normal.
    bool is_open(uint32_t surface, bool front) const {
        return m_sides[2 * size_t(surface) + (front ? 0 : 1)] != Side::closed;
    }
    // Whether light can come to a point from the far side of the ray: it leaves the scene, or ends
    // where light gets to.
    bool leads_out(const V3d& point, const V3d& direction) const;

    size_t closed_count() const; // sides
    size_t mixed_count() const;  // sides that are open in part

  private:
    enum class Side : char { closed, mixed, open };

    void walk_from(const LightEmission& emission, const Workers& workers);
    Side side_of(uint32_t surface, bool front, int points) const;

    const EmbreeScene& m_rays;
    std::vector<Side> m_sides;        // by surface: front, back
    std::vector<uint64_t> m_meetings; // of walks, as m_sides
    std::optional<LitPoints> m_lit;
    bool m_all_open = true;
};

} // namespace ql
