#include "linespace/inject.h"

#include "base/check.h"
#include "base/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace ql {

namespace {

constexpr uint64_t kPhotonsPerChunk = 4096;
// Deposits of a round, about.
constexpr uint64_t kDepositsPerRound = uint64_t{1} << 22;
// Energy: weights are about 1, sums end at 5e11 of them. Finer for the thesis's estimators, whose
// weights are at most 1 and fall with the distance; sums end at 2e9.
constexpr int kEnergySumBits = 24;
constexpr int kCountSumBits = 32;

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// The mean over photons that the thesis takes has no place for parts of photons.
int branches_of(const InjectConfig& config) {
    return config.estimator == Estimator::energy ? config.branches : 1;
}

CacheHeader header_for(const PosedScene& scene, uint64_t scene_hash, const InjectConfig& config,
                       const VoxelGrid& grid, const LightEmission& emission) {
    const RenderSpace& space = scene.world().space;
    const double real = std::ldexp(1.0, scene.lights().exponent()) / (space.scale * space.scale);
    const bool energy = config.estimator == Estimator::energy;
    CacheHeader header;
    header.estimator = config.estimator;
    header.patches = config.patches;
    header.normal_classes = config.normal_classes;
    header.voxels = grid.counts;
    header.lower = space.to_world(grid.lower);
    header.cell = grid.cell / space.scale;
    header.max_depth = config.max_depth;
    header.branches = branches_of(config);
    header.blur = blur_metres(config.blur, header.cell);
    header.seed = config.seed;
    header.scene_hash = scene_hash;
    header.sum_bits = energy ? kEnergySumBits : kCountSumBits;
    header.unit = real * (energy ? emission.power() : emission.greatest_intensity());
    header.photons = {config.photons};
    header.weight_by_order.assign(size_t(config.max_depth) - 1, 0);
    header.caustic_by_order = header.weight_by_order;
    return header;
}

void check(const InjectConfig& config, const LightEmission& emission) {
    QL_CHECK(config.patches >= 1 && config.patches <= kMaxPatches);
    QL_CHECK(config.normal_classes == 1 || config.normal_classes == 6);
    QL_CHECK(config.max_depth >= 2);
    QL_CHECK(config.branches >= 1 && config.branches <= kMaxBranches);
    QL_CHECK(config.photons.begin < config.photons.end);
    if (config.estimator != Estimator::energy && config.blur.value > 0)
        throw usage_error(
            "--blur needs the estimator energy; caches of {} are blurred by ls-sample alone",
            name_of(config.estimator));
    if (config.estimator != Estimator::energy && !emission.empty() && !emission.is_punctual())
        throw usage_error("--estimator {} knows point and spot lights only; use energy",
                          name_of(config.estimator));
}

// Traces all photons in rounds of chunks.
PhotonCounts trace_all(const PhotonContext& context, PhotonTracer trace, const PhotonRange& range,
                       ShaftAccumulator& sums, const Workers& workers, Progress& progress) {
    PhotonCounts total;
    total.weight_by_order.resize(size_t(context.max_scatterings));
    total.caustic_by_order.resize(size_t(context.max_scatterings));
    std::vector<std::vector<Deposit>> chunks;
    std::vector<PhotonCounts> counts;
    double deposits_per_photon = 2 * context.branches; // a guess for a small first round
    progress.start("tracing photons", range.end - range.begin);
    for (uint64_t begin = range.begin; begin < range.end;) {
        // As many photons as make a round.
        const auto photons =
            uint64_t(double(kDepositsPerRound) / std::max(deposits_per_photon, 0.01));
        const uint64_t end =
            begin + std::min(range.end - begin, std::max(photons, kPhotonsPerChunk));
        const size_t count = size_t((end - begin + kPhotonsPerChunk - 1) / kPhotonsPerChunk);
        if (chunks.size() < count) chunks.resize(count);
        counts.assign(count, {});
        workers.for_each(count, [&](size_t c) {
            const uint64_t first = begin + c * kPhotonsPerChunk;
            const uint64_t last = std::min(end, first + kPhotonsPerChunk);
            chunks[c].reserve(size_t(1.05 * deposits_per_photon * double(last - first)));
            trace(context, first, last, chunks[c], counts[c]);
            progress.advance(last - first);
        });
        for (const PhotonCounts& c : counts)
            total.add(c);
        sums.add(chunks, workers);
        begin = end;
        deposits_per_photon = double(total.deposits) / double(end - range.begin);
    }
    progress.finish();
    return total;
}

} // namespace

CacheHeader inject_header(const PosedScene& scene, uint64_t scene_hash,
                          const InjectConfig& config) {
    const LightEmission emission(scene.lights());
    check(config, emission);
    return header_for(scene, scene_hash, config, grid_over(scene.world(), config.grid), emission);
}

LightCache inject(const PosedScene& scene, uint64_t scene_hash, const InjectConfig& config,
                  const Workers& workers, Progress& progress, InjectReport& report) {
    const World& world = scene.world();
    const Scene& source = *world.scene;
    const LightEmission emission(scene.lights());
    check(config, emission);
    const VoxelGrid grid = grid_over(world, config.grid);

    PhotonContext context{scene.rays(),
                          emission,
                          grid,
                          config.patches,
                          config.normal_classes,
                          config.estimator,
                          config.max_depth - 1,
                          branches_of(config),
                          config.seed,
                          1 / world.space.scale,
                          {},
                          nullptr,
                          {}};
    for (const Material& material : source.materials)
        context.takes_light.push_back(takes_light(material));

    // Find out which sides of the surfaces take part; the thesis takes all.
    std::optional<OpenSides> sides;
    if (config.estimator == Estimator::energy) {
        sides.emplace(scene.rays(), emission, workers);
        context.sides = &*sides;
    }

    // Trace.
    LightCache cache;
    cache.header = header_for(scene, scene_hash, config, grid, emission);
    context.blur = Blur(scene.rays(), context.sides, cache.header.blur * world.space.scale);
    auto start = Clock::now();
    ShaftAccumulator sums(grid.size(), cache.header.sum_bits);
    if (!emission.empty())
        report.photons =
            trace_all(context, photon_tracer_for(source), config.photons, sums, workers, progress);
    else
        report.photons.weight_by_order = report.photons.caustic_by_order =
            cache.header.weight_by_order;
    sums.move_to(cache, workers);
    cache.header.weight_by_order = report.photons.weight_by_order;
    cache.header.caustic_by_order = report.photons.caustic_by_order;
    cache.header.unclassified = report.photons.unclassified;
    report.seconds_tracing = seconds_since(start);

    // Measure the shafts in which light arrived.
    start = Clock::now();
    if (config.estimator == Estimator::energy) {
        const MaterialAlphaTest alpha_test;
        report.measure = measure_shafts(world, *sides, has_alpha(source) ? &alpha_test : nullptr,
                                        context.blur, config.measure, cache, workers, progress);
    }
    report.seconds_measuring = seconds_since(start);
    return cache;
}

} // namespace ql
