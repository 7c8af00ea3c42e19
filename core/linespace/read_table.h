// The cache made ready for reading: incident radiance by voxel and directed shaft.
//
// Radiance is in units of LightSet. Where photons are few, most shafts have none and the others are
// too bright. Therefore each takes a part of its radiance from the group of shafts around it
// (groups.h), and that one from its own: of n photons in a group of m members, n/(n + k m) of what
// a member holds itself and the rest of the mean of the group, which counts its dark shafts. The
// light of a voxel stays what it is. Immutable, hence safe to share between threads; 16 bytes a
// shaft or group.
#pragma once

#include "base/parallel.h"
#include "linespace/cache.h"
#include "linespace/groups.h"
#include "shading/lights.h"

#include <algorithm>

namespace ql {

struct ReadTableConfig {
    // k: the photons a member of a group with which it and the group weigh the same; 0 leaves every
    // shaft what it holds.
    double smoothing = 0;
};

class ReadTable {
  public:
    ReadTable(const LightCache& cache, const RenderSpace& space, const LightSet& lights,
              const ReadTableConfig& config, const Workers& workers);

    const VoxelGrid& grid() const { return m_grid; }
    int patches() const { return m_patches; }
    uint32_t directed_shafts() const { return m_directed_shafts; }
    // The number of an entry of the gated layer, and what leads from there to the caustic layer.
    uint32_t number_of(uint32_t shaft, const V3f& normal) const {
        return shaft + m_directed_shafts * uint32_t(normal_class(normal, m_classes));
    }
    uint32_t caustics_from() const { return m_directed_shafts * uint32_t(m_classes); }
    bool has_caustics() const { return m_has_caustics; }
    size_t memory_bytes() const {
        return (m_first.size() + m_group_first.size()) * sizeof(uint64_t) +
               (m_shafts.size() + m_groups.size()) * (sizeof(uint32_t) + sizeof(V3f));
    }

    // The share of the light of the gated layer, and of caustics, that has been scattered at most
    // that often.
    float share_up_to(int scatterings) const { return share_of(m_share, scatterings); }
    float caustic_share_up_to(int scatterings) const {
        return share_of(m_caustic_share, scatterings);
    }

    // Position of the entry in the cache's order; none if no light came that way.
    std::optional<uint64_t> find(uint32_t voxel, uint32_t shaft) const {
        const uint32_t* const begin = m_shafts.data() + m_first[voxel];
        const uint32_t* const end = m_shafts.data() + m_first[voxel + 1];
        const uint32_t* const at = std::lower_bound(begin, end, shaft);
        if (at == end || *at != shaft) return std::nullopt;
        return uint64_t(at - m_shafts.data());
    }
    // Of a shaft of either layer. A dark one of the gated layer has what its group gives it.
    V3f radiance(uint32_t voxel, uint32_t number) const {
        if (const auto entry = find(voxel, number)) return m_radiance[*entry];
        return m_groups.empty() || number >= caustics_from() ? V3f(0)
                                                             : of_dark_shaft(voxel, number);
    }
    std::span<const uint32_t> shafts_of(uint32_t voxel) const {
        return {m_shafts.data() + m_first[voxel], m_first[voxel + 1] - m_first[voxel]};
    }

  private:
    static float share_of(const std::vector<float>& shares, int scatterings) {
        if (scatterings < 1) return 0;
        return shares[std::min(size_t(scatterings), shares.size()) - 1];
    }
    void smooth(const LightCache& cache, double smoothing, const Workers& workers);
    V3f of_dark_shaft(uint32_t voxel, uint32_t number) const;

    VoxelGrid m_grid;
    int m_patches;
    int m_classes;
    uint32_t m_directed_shafts;
    bool m_has_caustics = false;
    std::vector<uint64_t> m_first;
    HugeVector<uint32_t> m_shafts;
    HugeVector<V3f> m_radiance;
    ShaftGroups m_all_groups;
    std::vector<uint64_t> m_group_first;
    std::vector<uint32_t> m_groups;
    std::vector<V3f> m_dark_radiance; // by group: of its members without light
    std::vector<float> m_share, m_caustic_share;
};

} // namespace ql
