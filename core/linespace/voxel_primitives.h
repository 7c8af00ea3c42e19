// Which triangles and shapes each voxel holds, wholly or in part.
//
// Triangles by the separating axis test of Akenine-Moeller, "Fast 3D triangle-box overlap testing",
// JGT 6 (2001), with a margin for rounding; shapes by their boxes. Lists are sorted by surface and
// primitive. Immutable once built.
#pragma once

#include "base/parallel.h"
#include "linespace/grid.h"

#include <span>
#include <vector>

namespace ql {

struct Primitive {
    uint32_t surface = 0;
    uint32_t triangle = 0; // of the surface's mesh; 0 for shapes
    auto operator<=>(const Primitive&) const = default;
};

class VoxelPrimitives {
  public:
    // wanted: by voxel; the others stay empty.
    VoxelPrimitives(const World& world, const VoxelGrid& grid, const std::vector<char>& wanted,
                    const Workers& workers);

    std::span<const Primitive> of(uint32_t voxel) const {
        return {m_items.data() + m_first[voxel], m_first[voxel + 1] - m_first[voxel]};
    }
    size_t size() const { return m_items.size(); }

  private:
    std::vector<uint64_t> m_first;
    std::vector<Primitive> m_items;
};

// Whether a triangle meets the box from 0 to size, both in the same units.
bool overlaps_box(const std::array<V3d, 3>& corners, const V3d& size);

} // namespace ql
