// Étendue of every shaft of a voxel: the integral of cos_a cos_b / r^2 dA_a dA_b over its patches.
//
// Closed forms for parallel and for perpendicular rectangles: Howell, "A catalog of radiation heat
// transfer configuration factors", C-13 and C-15 (times pi and the area). Where patches are far
// apart the closed forms cancel, and a Gauss-Legendre product rule takes their place. Summed over
// all exits, an entry patch has pi times its area. By symmetry 3 N^2 + 3 N^3 numbers hold all
// 15 N^4 shafts. Unit: (length unit of the voxel)^2 sr. Immutable.
#pragma once

#include "linespace/shaft.h"

#include <vector>

namespace ql {

class EtendueTable {
  public:
    // voxel: its three sides, positive.
    EtendueTable(const V3d& voxel, int patches);

    double operator()(const ShaftEnds& ends) const;
    double operator()(uint32_t directed) const { return (*this)(shaft_ends(directed, m_patches)); }

  private:
    double& parallel(int axis, int du, int dv);
    double& perpendicular(int axis, int depth_a, int depth_b, int along);

    int m_patches;
    std::vector<double> m_parallel;      // by axis, distance along u, distance along v
    std::vector<double> m_perpendicular; // by axis of the shared edge, depths, distance along it
};

} // namespace ql
