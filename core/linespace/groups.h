// Groups of shafts: all that enter a voxel by one face and would leave it by another, and all of a
// voxel.
//
// Groups keep classes of normals apart, as shafts do. The group of a pair of faces has the number
// of the directed shaft between them where a face is one patch, plus 30 for each class; the voxels
// of the classes follow. Immutable, hence safe to share between threads.
#pragma once

#include "linespace/shaft.h"

#include <span>
#include <vector>

namespace ql {

class ShaftGroups {
  public:
    static constexpr uint32_t kFacePairs = directed_shaft_count(1);

    ShaftGroups(int patches, int normal_classes)
        : m_patches(uint32_t(patches)), m_classes(uint32_t(normal_classes)) {}

    uint32_t size() const { return (kFacePairs + 1) * m_classes; }
    // The group of a shaft of the gated layer. number: shaft + 30 N^4 class.
    uint32_t of_shaft(uint32_t number) const {
        const uint32_t n4 = m_patches * m_patches * m_patches * m_patches;
        const uint32_t directed = kFacePairs * n4;
        const uint32_t shaft = number % directed;
        // Blocks of N^4 shafts by pair of faces, and the direction in the last bit.
        return 2 * (shaft / 2 / n4) + shaft % 2 + kFacePairs * (number / directed);
    }
    // The group of a group; none for a voxel as a whole.
    std::optional<uint32_t> of_group(uint32_t group) const {
        if (is_voxel(group)) return std::nullopt;
        return kFacePairs * m_classes + class_of(group);
    }
    bool is_voxel(uint32_t group) const { return group >= kFacePairs * m_classes; }
    uint32_t class_of(uint32_t group) const {
        return is_voxel(group) ? group - kFacePairs * m_classes : group / kFacePairs;
    }
    // Shafts of a face pair, or face pairs of a voxel.
    uint32_t members_of(uint32_t group) const {
        return is_voxel(group) ? kFacePairs : m_patches * m_patches * m_patches * m_patches;
    }

    // All groups that hold these shafts of the gated layer; sorted.
    std::vector<uint32_t> holding(std::span<const uint32_t> numbers) const;

  private:
    uint32_t m_patches, m_classes;
};

} // namespace ql
