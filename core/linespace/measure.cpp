#include "linespace/measure.h"

#include "linespace/etendue.h"
#include "linespace/line_hits.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

struct ShareEstimate {
    double share;
    int lines;
    bool found;
};

// How many hits and lines are added so that the inverse of the share is unbiased: one would be
// right for random lines. Stratified lines vary less the more of them hit; the constant is that at
// which the mean of indirect light in a Cornell box agrees with path tracing.
double added_hits(double met) {
    constexpr double kStratified = 0.5;
    return (1 + kStratified * met) / (1 + met);
}

// Which share of the hits lies on open lines. That takes rays for each: some of them tell.
struct OpenShare {
    static constexpr int kAll = 4, kEvery = 4; // the first so many hits, then one in so many

    static bool is_asked(int hit, int all) { return hit < all || hit % kEvery == 0; }
    void add(double weight, bool is_open) {
        m_asked += weight;
        m_open += is_open ? weight : 0;
    }
    bool is_known() const { return m_asked > 0; }
    double value() const { return is_known() ? m_open / m_asked : 1; }

  private:
    double m_asked = 0, m_open = 0;
};

// The share of a shaft's lines that meet a surface of that class, first or at all.
ShareEstimate share_of(const ShaftLines& source, LineHits& surfaces, uint32_t number,
                       int normal_class, bool first_only, const MeasureConfig& config) {
    surfaces.choose(source.low(), source.high());
    LineBlock block;
    double hits = 0, weights = 0, met = 0;
    int hit = 0;
    OpenShare open;
    // Caustics have no gate: as much surface is moved away as there.
    const bool moved = first_only && surfaces.is_blurred();
    const auto count = [&](size_t line, int found_class, double share) {
        if (found_class != normal_class) return;
        const double weight = share * double(block.weight[line]);
        if (!moved && OpenShare::is_asked(hit++, OpenShare::kAll))
            open.add(weight, surfaces.is_open(block, line));
        hits += weight;
        met += share;
    };
    int wanted = kLinesPerBlock;
    for (int lines = 0;;) {
        source.fill(lines, block);
        if (moved)
            surfaces.visit_moved(block, uint32_t(lines), number, count);
        else
            first_only ? surfaces.visit_first(block, count) : surfaces.visit_all(block, count);
        for (const float weight : block.weight)
            weights += double(weight);
        lines += kLinesPerBlock;
        // The first set decides how many lines are enough.
        const double open_met = met * open.value();
        if (lines == kLinesPerBlock && open_met < kLinesPerBlock) {
            const double needed = config.enough_hits * kLinesPerBlock / std::max(open_met, 0.5);
            wanted = int(std::ceil(needed / kLinesPerBlock)) * kLinesPerBlock;
            wanted = std::clamp(wanted, kLinesPerBlock, config.max_lines);
        }
        if (lines < wanted) continue;
        const double added = added_hits(open_met) * weights / lines;
        return {(hits * open.value() + added) / (weights + added), lines, open_met > 0};
    }
}

// Measures of groups, in the order of groups; unit of cell. Lines through the whole voxel go on
// until every class that is there has been met often enough. Where none of the first ones is
// closed, later lines and those of the shafts are not asked.
std::vector<double> group_measures(std::span<const uint32_t> groups, const ShaftGroups& all,
                                   const VoxelLines& source, uint32_t voxel, LineHits& surfaces,
                                   const MeasureConfig& config, uint64_t& lines_total) {
    surfaces.choose(V3f(0), V3f(1));
    const std::span<const VoxelLines::Block> blocks = source.of_voxel(voxel);
    const VoxelLines::Block* block = nullptr;
    std::vector<double> met(all.size(), 0.0);
    std::vector<OpenShare> open(all.size());
    const bool moved = surfaces.is_blurred();
    int hit = 0, closed = 0;
    const auto count = [&](size_t line, int normal_class, double share) {
        const uint32_t group =
            block->shafts[line] + ShaftGroups::kFacePairs * uint32_t(normal_class);
        const uint32_t parent = *all.of_group(group);
        if (!moved && OpenShare::is_asked(hit++, config.enough_open)) {
            const bool is_open = surfaces.is_open(block->lines, line);
            closed += is_open ? 0 : 1;
            open[group].add(share, is_open);
            open[parent].add(share, is_open);
        }
        met[group] += share;
        met[parent] += share;
    };
    const auto open_met = [&](uint32_t group) {
        const OpenShare& own = open[group];
        const bool of_voxel = all.is_voxel(group) || own.is_known();
        return met[group] * (of_voxel ? own : open[*all.of_group(group)]).value();
    };
    constexpr size_t kStep = 16; // blocks
    int lines = 0;
    // A function of the voxel alone, not of the groups that are asked for: shards must agree.
    const auto is_enough = [&] {
        for (uint32_t group = 0; group < all.size(); ++group)
            if (all.is_voxel(group) && open_met(group) > 0 &&
                open_met(group) < config.enough_voxel_hits)
                return false;
        return lines >= config.least_voxel_lines;
    };
    for (size_t n = 0; n < blocks.size() && !is_enough(); n += kStep) {
        for (const VoxelLines::Block& next :
             blocks.subspan(n, std::min(kStep, blocks.size() - n))) {
            block = &next;
            if (moved)
                surfaces.visit_moved(next.lines, uint32_t(lines), ~0u, count);
            else
                surfaces.visit_first(next.lines, count);
            lines += kLinesPerBlock;
        }
        if (!moved && hit >= config.enough_open && closed == 0) surfaces.take_as_open();
    }
    lines_total += uint64_t(lines);
    std::vector<double> measures;
    for (const uint32_t group : groups) {
        const double added = added_hits(open_met(group));
        measures.push_back(source.measure() * (open_met(group) + added) / (lines + added));
    }
    return measures;
}

double weight_of(const LightCache& cache, uint64_t i) {
    const ShaftSum& sum = cache.sums[i];
    return std::ldexp(double(sum[0]) + double(sum[1]) + double(sum[2]), -cache.header.sum_bits) / 3;
}

} // namespace

MeasureReport measure_shafts(const World& world, const OpenSides& sides,
                             const AlphaTest* alpha_test, const Blur& blur,
                             const MeasureConfig& config, LightCache& cache, const Workers& workers,
                             Progress& progress) {
    const VoxelGrid grid = grid_of(cache.header, world.space);
    const ShaftGroups all_groups(cache.header.patches, cache.header.normal_classes);
    const EtendueTable etendue(cache.header.cell, cache.header.patches);
    const double metres = 1 / world.space.scale;
    const size_t voxels = grid.size();
    std::vector<char> wanted(voxels);
    std::vector<uint32_t> filled;
    for (size_t v = 0; v < voxels; ++v) {
        wanted[v] = cache.first[v + 1] > cache.first[v];
        if (wanted[v]) filled.push_back(uint32_t(v));
    }
    const VoxelPrimitives primitives(world, grid, wanted, workers);
    const VoxelLines voxel_lines(grid.cell, config.max_voxel_lines, workers);

    cache.measures.resize(cache.size());
    std::vector<MeasureReport> reports(filled.size());
    std::vector<std::vector<uint32_t>> groups(filled.size());
    std::vector<std::vector<float>> measures(filled.size());
    const int patches = cache.header.patches, classes = cache.header.normal_classes;
    const uint32_t directed = cache.header.directed();
    progress.start("measuring shafts", filled.size());
    workers.for_each(filled.size(), [&](size_t n) {
        const uint32_t voxel = filled[n];
        LineHits surfaces(world, sides, alpha_test, blur, grid, voxel, primitives.of(voxel),
                          classes);
        MeasureReport& report = reports[n];
        groups[n] = all_groups.holding(cache.gated_shafts_of(voxel));
        for (const double measure : group_measures(groups[n], all_groups, voxel_lines, voxel,
                                                   surfaces, config, report.lines))
            measures[n].push_back(float(measure * metres * metres));
        for (uint64_t i = cache.first[voxel]; i < cache.first[voxel + 1]; ++i) {
            const uint32_t number = cache.shafts[i];
            const ShaftEnds ends = shaft_ends(number % directed, patches);
            const ShareEstimate estimate = share_of(
                ShaftLines(ends, patches, grid.cell, voxel, number), surfaces, number,
                int(number / directed) % classes, number < cache.header.caustics_from(), config);
            cache.measures[i] = float(etendue(ends) * estimate.share);
            report.lines += uint64_t(estimate.lines);
            if (estimate.found) continue;
            ++report.unmeasured_shafts;
            report.unmeasured_weight += weight_of(cache, i);
        }
        progress.advance();
    });
    progress.finish();

    // Put the groups of all voxels together.
    cache.group_first.assign(voxels + 1, 0);
    for (size_t n = 0; n < filled.size(); ++n)
        cache.group_first[filled[n] + 1] = groups[n].size();
    for (size_t v = 0; v < voxels; ++v)
        cache.group_first[v + 1] += cache.group_first[v];
    cache.groups.clear();
    cache.group_measures.clear();
    cache.groups.reserve(cache.group_first.back());
    cache.group_measures.reserve(cache.group_first.back());
    MeasureReport report;
    for (size_t n = 0; n < filled.size(); ++n) {
        cache.groups.insert(cache.groups.end(), groups[n].begin(), groups[n].end());
        cache.group_measures.insert(cache.group_measures.end(), measures[n].begin(),
                                    measures[n].end());
        groups[n] = {};
        measures[n] = {};
        report.lines += reports[n].lines;
        report.unmeasured_shafts += reports[n].unmeasured_shafts;
        report.unmeasured_weight += reports[n].unmeasured_weight;
    }
    return report;
}

} // namespace ql
