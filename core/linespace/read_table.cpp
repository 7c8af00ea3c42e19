#include "linespace/read_table.h"

#include <cmath>
#include <numbers>

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

} // namespace

ReadTable::ReadTable(const LightCache& cache, const RenderSpace& space, const LightSet& lights,
                     const ReadTableConfig& config, const Workers& workers)
    : m_grid(grid_of(cache.header, space)), m_patches(cache.header.patches),
      m_classes(cache.header.normal_classes), m_directed_shafts(directed_shaft_count(m_patches)),
      m_first(cache.first), m_shafts(cache.shafts), m_radiance(cache.size()),
      m_all_groups(m_patches, m_classes), m_share(cumulative_shares(cache.header.weight_by_order)),
      m_caustic_share(cumulative_shares(cache.header.caustic_by_order)) {
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
    if (config.smoothing > 0 && cache.header.estimator == Estimator::energy)
        smooth(cache, config.smoothing, workers);
}

void ReadTable::smooth(const LightCache& cache, double smoothing, const Workers& workers) {
    m_group_first = cache.group_first;
    m_groups = cache.groups;
    m_dark_radiance.resize(m_groups.size());
    struct Sum {
        V3d light = {0, 0, 0}; // radiance times measure
        double photons = 0;
        double measure = 0;
        V3d radiance = {0, 0, 0}; // smoothed
        double own = 0;           // share of its own light that a member keeps
        std::optional<size_t> above;
    };
    workers.for_each(m_first.size() - 1, [&](size_t v) {
        const auto voxel = uint32_t(v);
        const size_t begin = m_group_first[v], count = m_group_first[v + 1] - begin;
        const auto position = [&](uint32_t group) {
            const auto at = std::lower_bound(m_groups.begin() + int64_t(begin),
                                             m_groups.begin() + int64_t(begin + count), group);
            return size_t(at - m_groups.begin()) - begin;
        };
        // Add up the light of each group; coarser ones come later.
        std::vector<Sum> sums(count);
        std::vector<size_t> group_of;
        const auto shafts = cache.gated_shafts_of(voxel);
        for (size_t i = 0; i < shafts.size(); ++i) {
            const size_t entry = m_first[v] + i;
            group_of.push_back(position(m_all_groups.of_shaft(shafts[i])));
            Sum& sum = sums[group_of.back()];
            sum.light += V3d(m_radiance[entry]) * double(cache.measures[entry]);
            sum.photons += double(cache.counts[entry]);
        }
        for (size_t g = 0; g < count; ++g) {
            Sum& sum = sums[g];
            sum.measure = double(cache.group_measures[begin + g]);
            const double members = m_all_groups.members_of(m_groups[begin + g]);
            sum.own = sum.photons / (sum.photons + smoothing * members);
            const auto above = m_all_groups.of_group(m_groups[begin + g]);
            if (!above) continue;
            sum.above = position(*above);
            sums[*sum.above].light += sum.light;
            sums[*sum.above].photons += sum.photons;
        }
        // Hand it down again: what members hold themselves is scaled to what their group has now.
        const auto handed_down = [](const Sum& from, const V3d& own_light, double measure) {
            V3d radiance = from.radiance * (1 - from.own);
            for (int c = 0; c < 3; ++c)
                if (own_light[c] > 0)
                    radiance[c] += from.own * from.radiance[c] * from.measure / from.light[c] *
                                   (own_light[c] / measure);
            return radiance;
        };
        for (size_t g = count; g-- > 0;) {
            Sum& sum = sums[g];
            sum.radiance = sum.above ? handed_down(sums[*sum.above], sum.light, sum.measure)
                                     : sum.light / sum.measure;
            m_dark_radiance[begin + g] = V3f(sum.radiance * (1 - sum.own));
        }
        for (size_t i = 0; i < group_of.size(); ++i) {
            V3f& radiance = m_radiance[m_first[v] + i];
            const double measure = double(cache.measures[m_first[v] + i]);
            radiance = V3f(handed_down(sums[group_of[i]], V3d(radiance) * measure, measure));
        }
    });
}

V3f ReadTable::of_dark_shaft(uint32_t voxel, uint32_t number) const {
    const uint32_t* const begin = m_groups.data() + m_group_first[voxel];
    const uint32_t* const end = m_groups.data() + m_group_first[voxel + 1];
    std::optional<uint32_t> group = m_all_groups.of_shaft(number);
    for (; group; group = m_all_groups.of_group(*group)) {
        const uint32_t* const at = std::lower_bound(begin, end, *group);
        if (at != end && *at == *group) return m_dark_radiance[size_t(at - m_groups.data())];
    }
    return V3f(0);
}

} // namespace ql
