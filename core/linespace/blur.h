// The blur that hides the voxels: a point is looked up elsewhere, on a disc across its normal.
//
// Nilles 2017, section 4.2.3, moves the points of reads alone. Here deposits move too, and the
// measure knows of it: a point moves only where the disc's point lies on a surface that takes light
// too and faces the same way, and stays where it is otherwise. Then as much surface moves away from
// every place as moves there, and the energy of the cache is that of the light. Safe to share
// between threads.
#pragma once

#include "linespace/open_sides.h"

#include <algorithm>

namespace ql {

// A length in metres or in voxels, by their shortest side.
struct BlurRadius {
    double value = 0;
    bool in_voxels = false;
};

double blur_metres(const BlurRadius& radius, const V3d& cell);

class Blur {
  public:
    Blur() = default; // none
    // sides may be null: all are open. Both must outlive it. radius: in render space, 0 for none.
    Blur(const EmbreeScene& rays, const OpenSides* sides, double radius)
        : m_rays(&rays), m_sides(sides), m_radius(float(std::min(radius, kBeyondScenes))) {}

    bool is_on() const { return m_radius > 0; }
    // How far a point is moved. normal: unit, on the side that the light comes to; offset: of rays
    // that start there; u: two uniform numbers.
    V3f shift(const V3f& position, const V3f& normal, float offset, const V2f& u,
              uint32_t alpha_key) const;
    // Whether light comes to the point from direction w, and from further away than `distance`.
    bool is_lit_from(const V3f& position, const V3f& normal, float offset, const V3f& w,
                     double distance, uint32_t alpha_key) const;

  private:
    // In render space, where scenes are of order 1: no disc of that size meets anything.
    static constexpr double kBeyondScenes = 1e6;

    const EmbreeScene* m_rays = nullptr;
    const OpenSides* m_sides = nullptr;
    float m_radius = 0;
};

} // namespace ql
