#include "linespace/read_table.h"

#include <cmath>
#include <numbers>
#include <unordered_map>

namespace ql {

namespace {

// What an entry's sums are multiplied with to become radiance in real units.
double radiance_per_sum(const LightCache& cache, size_t i) {
    const CacheHeader& h = cache.header;
    const double weight = std::ldexp(h.unit, -h.sum_bits);
    if (h.estimator == Estimator::energy)
        return weight / double(h.photon_count()) / double(cache.measures[i]);
    // Nilles 2017 takes the mean over photons for an illuminance and leaves the 1/pi of diffuse
    // reflection out of direct light as well; ours has it.
    return weight / double(cache.counts[i]) / std::numbers::pi;
}

std::vector<float> cumulative_shares(const std::vector<int64_t>& weights) {
    std::vector<float> shares;
    double total = 0, sum = 0;
    for (const int64_t weight : weights)
        total += double(weight);
    for (const int64_t weight : weights) {
        sum += double(weight);
        shares.push_back(total > 0 ? float(sum / total) : 1);
    }
    shares.back() = 1;
    return shares;
}

// The directed shaft of the coarser Linespace that holds this one.
uint32_t parent_of(uint32_t directed, int patches) {
    ShaftEnds ends = shaft_ends(directed, patches);
    const auto parent = [&](int patch) {
        return patch / patches / 2 * (patches / 2) + patch % patches / 2;
    };
    ends.entry_patch = parent(ends.entry_patch);
    ends.exit_patch = parent(ends.exit_patch);
    return directed_shaft(ends, patches / 2);
}

} // namespace

ReadTable::ReadTable(const LightCache& cache, const RenderSpace& space, const LightSet& lights,
                     const ReadTableConfig& config, const Workers& workers)
    : m_grid(grid_of(cache.header, space)), m_patches(cache.header.patches),
      m_classes(cache.header.normal_classes), m_directed_shafts(directed_shaft_count(m_patches)),
      m_estimator(cache.header.estimator), m_first(cache.first), m_shafts(cache.shafts),
      m_radiance(cache.size()), m_share(cumulative_shares(cache.header.weight_by_order)) {
    const double stored_from_real = std::ldexp(1.0, -lights.exponent());
    constexpr size_t kBlock = 1 << 16;
    workers.for_each((cache.size() + kBlock - 1) / kBlock, [&](size_t block) {
        for (size_t i = block * kBlock; i < std::min(cache.size(), (block + 1) * kBlock); ++i) {
            const double scale = radiance_per_sum(cache, i) * stored_from_real;
            for (size_t c = 0; c < 3; ++c)
                m_radiance[i][int(c)] = float(double(cache.sums[i][c]) * scale);
        }
    });
    m_has_caustics = std::any_of(m_shafts.begin(), m_shafts.end(),
                                 [&](uint32_t shaft) { return shaft >= caustics_from(); });
    if (config.shrinkage > 0 && m_patches % 2 == 0 && m_estimator == Estimator::energy)
        shrink(cache, config.shrinkage, workers);
}

void ReadTable::shrink(const LightCache& cache, double shrinkage, const Workers& workers) {
    double total = 0;
    for (const float measure : cache.measures)
        total += double(measure);
    const double reference = shrinkage * total / double(std::max<size_t>(cache.size(), 1));
    struct Group {
        double weight = 0; // sum of pull times measure
        V3d light = {0, 0, 0};
    };
    workers.for_each(m_first.size() - 1, [&](size_t voxel) {
        // Gather what is to be shared in each group, then hand it out evenly.
        const auto shafts = shafts_of(uint32_t(voxel));
        std::unordered_map<uint32_t, Group> groups;
        const auto pull = [&](size_t i) {
            return 1 / (1 + double(cache.measures[m_first[voxel] + i]) / reference);
        };
        const auto group_of = [&](size_t i) -> Group* {
            if (shafts[i] >= caustics_from()) return nullptr;
            const uint32_t shaft = shafts[i] % m_directed_shafts;
            return &groups[parent_of(shaft, m_patches) + (shafts[i] - shaft)];
        };
        for (size_t i = 0; i < shafts.size(); ++i)
            if (Group* group = group_of(i)) {
                const double share = pull(i) * double(cache.measures[m_first[voxel] + i]);
                group->weight += share;
                group->light += V3d(m_radiance[m_first[voxel] + i]) * share;
            }
        for (size_t i = 0; i < shafts.size(); ++i)
            if (const Group* group = group_of(i); group && group->weight > 0) {
                V3f& radiance = m_radiance[m_first[voxel] + i];
                radiance =
                    V3f(V3d(radiance) * (1 - pull(i)) + group->light * (pull(i) / group->weight));
            }
    });
}

} // namespace ql
