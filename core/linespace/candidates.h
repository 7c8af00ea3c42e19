// Lists of the primitives inside each shaft: "what is the first hit inside this shaft?" without a
// tree.
//
// Source: Nilles 2017, sections 4.2.1 and 5.2.4. A shaft's convex hull has at most ten planes: the
// two patches and up to eight sides. A primitive is a candidate if something of it is left after
// clipping against all of them. Lists are counted, given their places by a prefix sum, and filled.
// Shafts that hold light have a list; all others ask their whole voxel. Triangles and shapes
// without alpha. Immutable once built.
#pragma once

#include "geometry/embree_scene.h"
#include "linespace/read_table.h"
#include "linespace/voxel_primitives.h"

namespace ql {

// A half space: points p with normal.p <= offset are inside.
struct HullPlane {
    V3d normal;
    double offset;
};

// The planes around two patches of the unit voxel, at most ten.
std::vector<HullPlane> shaft_hull(const ShaftEnds& ends, int patches);

// Whether anything of a triangle, in coordinates of the unit voxel, is left inside of the hull.
bool overlaps_hull(const std::vector<HullPlane>& hull, const std::array<V3d, 3>& triangle);

class ShaftCandidates {
  public:
    // The table must outlive it. Errors: ErrorKind::usage where a material has an alpha mode.
    ShaftCandidates(const World& world, const ReadTable& table, const Workers& workers);

    // The nearest hit up to ray.t_far on a ray from a point of that shaft. number: of the entry.
    bool intersect(const Ray& ray, uint32_t voxel, uint32_t number, Hit& hit) const;

    size_t memory_bytes() const {
        return m_first.size() * sizeof(uint64_t) +
               (m_items.size() + m_voxels.size()) * sizeof(Primitive);
    }
    size_t size() const { return m_items.size(); }

  private:
    const World& m_world;
    const ReadTable& m_table;
    VoxelPrimitives m_voxels;
    std::vector<uint64_t> m_first; // by entry of the table
    std::vector<Primitive> m_items;
};

} // namespace ql
