#include "linespace/cache.h"

#include "base/error.h"

#include <algorithm>
#include <optional>

namespace ql {

namespace {

void add_exactly(int64_t& sum, int64_t value, const std::string& what) {
    if (__builtin_add_overflow(sum, value, &sum))
        throw input_error("{}: sums beyond 64 bits", what);
}

// Adds entry j of b to entry i of the result.
void add_entry(LightCache& to, size_t i, const LightCache& b, size_t j, const std::string& what) {
    if (__builtin_add_overflow(to.counts[i], b.counts[j], &to.counts[i]))
        throw input_error("{}: more than 2^32 photons in a shaft", what);
    for (size_t c = 0; c < 3; ++c)
        add_exactly(to.sums[i][c], b.sums[j][c], what);
    if (!to.measures.empty() && to.measures[i] != b.measures[j])
        throw input_error("{}: not of the same scene: measures differ", what);
}

void append_entry(LightCache& to, const LightCache& from, size_t i) {
    to.shafts.push_back(from.shafts[i]);
    to.counts.push_back(from.counts[i]);
    to.sums.push_back(from.sums[i]);
    if (!from.measures.empty()) to.measures.push_back(from.measures[i]);
}

// What must agree, with a name for messages.
void require_fit(const CacheHeader& a, const CacheHeader& b, const std::string& what) {
    const auto require = [&](bool same, const char* name) {
        if (!same) throw input_error("{}: {} differs, expected caches of one run", what, name);
    };
    require(a.scene_hash == b.scene_hash, "the scene");
    require(a.estimator == b.estimator, "the estimator");
    require(a.normal_classes == b.normal_classes, "the number of normal classes");
    require(a.patches == b.patches && a.voxels == b.voxels, "the number of voxels or patches");
    require(a.lower == b.lower && a.cell == b.cell, "the grid");
    require(a.max_depth == b.max_depth, "the depth");
    require(a.branches == b.branches, "the number of branches");
    require(a.blur == b.blur, "the blur");
    require(a.seed == b.seed, "the seed");
    require(a.sum_bits == b.sum_bits && a.unit == b.unit, "the unit of the sums");
    require(a.weight_by_order.size() == b.weight_by_order.size(), "the depth");
}

// Walks two sorted lists: visit(i, j) for what stands in both, with none for a side that lacks it.
template<class Visit>
void for_each_of_both(std::span<const uint32_t> a, std::span<const uint32_t> b, Visit&& visit) {
    for (size_t i = 0, j = 0; i < a.size() || j < b.size();) {
        const bool has_a = i < a.size() && (j == b.size() || a[i] <= b[j]);
        const bool has_b = j < b.size() && (i == a.size() || b[j] <= a[i]);
        visit(has_a ? std::optional(i) : std::nullopt, has_b ? std::optional(j) : std::nullopt);
        i += has_a;
        j += has_b;
    }
}

std::span<const uint32_t> part_of(std::span<const uint32_t> values,
                                  const std::vector<uint64_t>& first, size_t voxel) {
    return std::span(values).subspan(first[voxel], first[voxel + 1] - first[voxel]);
}

// The groups of both, with measures that must agree where they meet.
void merge_groups(LightCache& to, const LightCache& a, const LightCache& b,
                  const std::string& what) {
    to.group_first.assign(a.group_first.size(), 0);
    for (size_t v = 0; v + 1 < a.group_first.size(); ++v) {
        const auto append = [&](std::optional<size_t> i, std::optional<size_t> j) {
            const LightCache& from = i ? a : b;
            const size_t at = i ? a.group_first[v] + *i : b.group_first[v] + *j;
            if (i && j && a.group_measures[at] != b.group_measures[b.group_first[v] + *j])
                throw input_error("{}: not of the same scene: measures differ", what);
            to.groups.push_back(from.groups[at]);
            to.group_measures.push_back(from.group_measures[at]);
        };
        for_each_of_both(part_of(a.groups, a.group_first, v), part_of(b.groups, b.group_first, v),
                         append);
        to.group_first[v + 1] = to.groups.size();
    }
}

} // namespace

std::string name_of(Estimator estimator) {
    switch (estimator) {
    case Estimator::energy:
        return "energy";
    case Estimator::count_text:
        return "count-text";
    case Estimator::count_listing:
        return "count-listing";
    }
    return {};
}

Estimator estimator_named(const std::string& name) {
    for (const Estimator e : {Estimator::energy, Estimator::count_text, Estimator::count_listing})
        if (name_of(e) == name) return e;
    throw input_error("estimator '{}', expected energy, count-text or count-listing", name);
}

uint64_t CacheHeader::photon_count() const {
    uint64_t count = 0;
    for (const PhotonRange& range : photons)
        count += range.end - range.begin;
    return count;
}

std::span<const uint32_t> LightCache::gated_shafts_of(uint64_t voxel) const {
    const auto begin = shafts.begin() + int64_t(first[voxel]);
    const auto end = shafts.begin() + int64_t(first[voxel + 1]);
    return {begin, std::lower_bound(begin, end, header.caustics_from())};
}

size_t LightCache::memory_bytes() const {
    return first.size() * sizeof(uint64_t) + size() * (2 * sizeof(uint32_t) + sizeof(ShaftSum)) +
           measures.size() * sizeof(float) + group_first.size() * sizeof(uint64_t) +
           groups.size() * (sizeof(uint32_t) + sizeof(float));
}

VoxelGrid grid_of(const CacheHeader& header, const RenderSpace& space) {
    return {space.from_world(header.lower), header.cell * space.scale, header.voxels};
}

std::vector<PhotonRange> joined(const std::vector<PhotonRange>& a,
                                const std::vector<PhotonRange>& b) {
    std::vector<PhotonRange> all = a;
    all.insert(all.end(), b.begin(), b.end());
    std::sort(all.begin(), all.end(),
              [](const PhotonRange& x, const PhotonRange& y) { return x.begin < y.begin; });
    std::vector<PhotonRange> result;
    for (const PhotonRange& range : all) {
        if (!result.empty() && range.begin < result.back().end)
            throw input_error("photons {}:{} are in both", range.begin,
                              std::min(range.end, result.back().end));
        if (!result.empty() && range.begin == result.back().end)
            result.back().end = range.end;
        else
            result.push_back(range);
    }
    return result;
}

void require_mergeable(const CacheHeader& a, const CacheHeader& b, const std::string& what) {
    require_fit(a, b, what);
    try {
        joined(a.photons, b.photons);
    } catch (const Error& e) {
        throw input_error("{}: {}", what, e.what());
    }
}

LightCache merged(const LightCache& a, const LightCache& b, const std::string& what) {
    require_mergeable(a.header, b.header, what);
    LightCache result;
    result.header = a.header;
    result.header.photons = joined(a.header.photons, b.header.photons);
    for (size_t i = 0; i < a.header.weight_by_order.size(); ++i) {
        add_exactly(result.header.weight_by_order[i], b.header.weight_by_order[i], what);
        add_exactly(result.header.caustic_by_order[i], b.header.caustic_by_order[i], what);
    }
    add_exactly(result.header.unclassified, b.header.unclassified, what);

    // Merge the sorted lists of each voxel.
    const size_t most = a.size() + b.size();
    result.shafts.reserve(most);
    result.counts.reserve(most);
    result.sums.reserve(most);
    result.measures.reserve(a.measures.empty() ? 0 : most);
    result.first.assign(a.first.size(), 0);
    for (size_t v = 0; v + 1 < a.first.size(); ++v) {
        const auto append = [&](std::optional<size_t> i, std::optional<size_t> j) {
            append_entry(result, i ? a : b, i ? a.first[v] + *i : b.first[v] + *j);
            if (i && j) add_entry(result, result.size() - 1, b, b.first[v] + *j, what);
        };
        for_each_of_both(part_of(a.shafts, a.first, v), part_of(b.shafts, b.first, v), append);
        result.first[v + 1] = result.size();
    }
    merge_groups(result, a, b, what);
    return result;
}

} // namespace ql
