#include "linespace/sample.h"

#include "base/check.h"
#include "base/error.h"
#include "render/film.h"
#include "render/path_tracer.h"

#include <cmath>

namespace ql {

namespace {

constexpr int kTileSize = 16;
constexpr std::pair<const char*, uint32_t> kLayers[] = {{"direct", kLayerDirect},
                                                        {"indirect", kLayerIndirect},
                                                        {"cached", kLayerCached},
                                                        {"caustic", kLayerCaustic},
                                                        {"variance", kLayerVariance}};

struct ReadJob {
    const PixelCamera& camera;
    const Array2D<uint32_t>& seeds;
    const SampleConfig& config;
    ReadContext context;
    Image image;
    VectorPlanes beauty;
    std::array<VectorPlanes, std::size(kLayers)> layers;
};

struct TileCounts {
    ReadCounts counts;
    uint64_t discarded = 0;
};

// Sums of a pixel by layer; the fifth is of the squares.
struct PixelSums {
    V3d total{0, 0, 0};
    std::array<V3d, 5> layers{V3d(0), V3d(0), V3d(0), V3d(0), V3d(0)};
    int samples = 0;
};

bool is_finite(const ReadSample& s) {
    const V3f sum = s.direct + s.indirect;
    return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z);
}

void add(const ReadSample& s, PixelSums& sums) {
    const V3d total = V3d(s.direct) + V3d(s.indirect);
    sums.total += total;
    sums.layers[0] += V3d(s.direct);
    sums.layers[1] += V3d(s.indirect);
    sums.layers[2] += V3d(s.cached);
    sums.layers[3] += V3d(s.caustic);
    sums.layers[4] += total * total;
    ++sums.samples;
}

void write_pixel(ReadJob& frame, int x, int y, const PixelSums& sums) {
    const double real = std::ldexp(1.0, frame.context.lights.exponent());
    const double n = std::max(sums.samples, 1);
    const V3d mean = sums.total / n;
    frame.beauty.set(x, y, mean * real);
    for (size_t i = 0; i < std::size(kLayers); ++i) {
        if (!frame.layers[i]) continue;
        V3d value = sums.layers[i] * (real / n);
        if (kLayers[i].second == kLayerVariance)
            for (int c = 0; c < 3; ++c)
                value[c] = std::max(0.0, sums.layers[i][c] / n - mean[c] * mean[c]) /
                           std::max(n - 1, 1.0) * real * real;
        frame.layers[i].set(x, y, value);
    }
}

using TileSampler = TileCounts (*)(ReadJob& frame, size_t tile);

template<uint32_t Lobes>
TileCounts sample_tile(ReadJob& frame, size_t tile) {
    const int width = frame.seeds.width(), height = frame.seeds.height();
    const size_t across = size_t((width + kTileSize - 1) / kTileSize);
    const int x0 = int(tile % across) * kTileSize, y0 = int(tile / across) * kTileSize;
    TileCounts tile_counts;
    const ReadKernel<Lobes> kernel(frame.context, tile_counts.counts);
    for (int y = y0; y < std::min(y0 + kTileSize, height); ++y)
        for (int x = x0; x < std::min(x0 + kTileSize, width); ++x) {
            PixelSums sums;
            for (int s = 0; s < frame.config.spp; ++s) {
                const PixelRandom random(frame.seeds(x, y), uint32_t(s));
                const RandomWords words = random.words(0);
                const Ray ray = frame.camera.ray(double(x) + double(unit_float(words[0])),
                                                 double(y) + double(unit_float(words[1])));
                const ReadSample sample = kernel.trace(ray, random, words[2]);
                if (is_finite(sample))
                    add(sample, sums);
                else
                    ++tile_counts.discarded;
            }
            write_pixel(frame, x, y, sums);
        }
    return tile_counts;
}

TileSampler sampler_for(const Scene& scene) {
    return choose_kernel(scene).lobes == kLobeDiffuse ? sample_tile<kLobeDiffuse>
                                                      : sample_tile<kAllLobes>;
}

void add_planes(ReadJob& frame) {
    frame.beauty = VectorPlanes(frame.image, "", "RGB");
    for (size_t i = 0; i < std::size(kLayers); ++i)
        if (frame.config.layers & kLayers[i].second)
            frame.layers[i] = VectorPlanes(frame.image, std::string(kLayers[i].first) + ".", "RGB");
}

void add(ReadCounts& to, const ReadCounts& from) {
    to.rays.add(from.rays);
    to.reads += from.reads;
    to.near_hits += from.near_hits;
    to.dark += from.dark;
}

} // namespace

uint32_t parse_read_layers(const std::string& names) {
    uint32_t layers = 0;
    for (size_t at = 0; at <= names.size();) {
        const size_t comma = std::min(names.find(',', at), names.size());
        const std::string name = names.substr(at, comma - at);
        uint32_t found = 0;
        for (const auto& [known, layer] : kLayers)
            if (name == known || name == "all") found |= layer;
        if (!found)
            throw usage_error("--layers {}: expected direct, indirect, cached, caustic, variance "
                              "or all",
                              name);
        layers |= found;
        at = comma + 1;
    }
    return layers;
}

SampleResult sample_frame(const PosedScene& scene, const PixelCamera& camera,
                          const ReadTable& table, const ShaftCandidates* candidates,
                          const OpenSides* sides, const Array2D<uint32_t>& seeds,
                          const SampleConfig& config, const Workers& workers, Progress& progress) {
    QL_CHECK(config.spp >= 1 && config.read.max_depth >= 1 && config.read.reads >= 1);
    const Scene& source = *scene.world().scene;
    ReadJob frame{camera,
                  seeds,
                  config,
                  {scene.rays(), scene.lights(), table, candidates, sides, config.read,
                   Blur(scene.rays(), sides, config.blur_metres * scene.world().space.scale),
                   has_emission(source)},
                  Image(seeds.width(), seeds.height()),
                  {},
                  {}};
    add_planes(frame);
    const TileSampler sample = sampler_for(source);
    const size_t across = size_t((seeds.width() + kTileSize - 1) / kTileSize);
    const size_t down = size_t((seeds.height() + kTileSize - 1) / kTileSize);
    std::vector<TileCounts> counts(across * down);
    progress.start("sampling", counts.size());
    workers.for_each(counts.size(), [&](size_t tile) {
        counts[tile] = sample(frame, tile);
        progress.advance();
    });
    progress.finish();
    SampleResult result;
    for (const TileCounts& tile : counts) {
        add(result.counts, tile.counts);
        result.discarded_samples += tile.discarded;
    }
    result.image = std::move(frame.image);
    return result;
}

} // namespace ql
