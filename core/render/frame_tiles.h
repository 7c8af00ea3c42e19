// The tile loop of the path tracer, a template over its kernel. Included by the files that compile
// one group of kernels each.
#pragma once

#include "render/path_tracer.h"

#include <algorithm>
#include <cmath>

namespace ql {

// A frame in the making, shared by all tiles.
struct FrameJob {
    const PosedScene& scene;
    const PixelCamera& camera;
    const Array2D<uint32_t>& seeds;
    const RenderConfig& config;
    const NextFrame* next;
    const std::vector<Affine>& next_from_now; // world to world, by node; empty: nothing moves
    PathContext context;
    Film& film;
};

struct TileCounts {
    RayCounts rays;
    uint64_t discarded_samples = 0;
};

inline constexpr int kTileSize = 16;

// Renders tile number `tile` (row by row) of the frame.
using TileRenderer = TileCounts (*)(const FrameJob& job, size_t tile);

TileRenderer diffuse_tile_renderer();
TileRenderer general_tile_renderer();
// Dithered sampling is for comparison, not for speed: one kernel serves every scene.
TileRenderer dithered_tile_renderer();

namespace detail {

// Sums of one pixel, in double: a million samples lose nothing.
struct PixelSums {
    V3d direct{0, 0, 0}, indirect{0, 0, 0}, squares{0, 0, 0};
    V3d normal{0, 0, 0}, position{0, 0, 0}, albedo{0, 0, 0};
    double depth = 0, motion_x = 0, motion_y = 0;
    uint32_t id = 0;
    int samples = 0, hits = 0;
    int moved = 0; // hits that the next camera sees, too
};

inline bool is_finite(const V3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

inline void add_radiance(const PathSample& sample, PixelSums& sums) {
    const V3d direct(sample.direct), indirect(sample.indirect);
    const V3d total = direct + indirect;
    sums.direct += direct;
    sums.indirect += indirect;
    sums.squares += V3d(total.x * total.x, total.y * total.y, total.z * total.z);
    ++sums.samples;
}

void add_first_hit(const FrameJob& job, const FirstHit& hit, double x, double y, PixelSums& sums);
void write_pixel(const FrameJob& job, int x, int y, const PixelSums& sums);

// Where the random numbers of a pixel's sample come from: its own seed, or the frame's dither.
struct FromSeeds {
    static PixelRandom random(const FrameJob& job, int x, int y, int sample) {
        return {job.seeds(x, y), uint32_t(sample)};
    }
};
struct FromDither {
    static DitheredRandom random(const FrameJob& job, int x, int y, int sample) {
        return {*job.config.dither, x, y, uint32_t(sample)};
    }
};

template<uint32_t Lobes, class Randoms = FromSeeds>
TileCounts render_tile(const FrameJob& job, size_t tile) {
    const int width = job.seeds.width(), height = job.seeds.height();
    const size_t tiles_across = size_t((width + kTileSize - 1) / kTileSize);
    const int x0 = int(tile % tiles_across) * kTileSize;
    const int y0 = int(tile / tiles_across) * kTileSize;
    const bool wants_first_hit = (job.config.aovs & kFirstHitAovs) != 0;
    RayCounter counter;
    TileCounts counts;
    const PathKernel<Lobes, RayCounter> kernel(job.context, counter);
    for (int y = y0; y < std::min(y0 + kTileSize, height); ++y)
        for (int x = x0; x < std::min(x0 + kTileSize, width); ++x) {
            PixelSums sums;
            for (int s = 0; s < job.config.spp; ++s) {
                const auto random = Randoms::random(job, x, y, s);
                const RandomWords words = random.words(0);
                const double px = double(x) + double(unit_float(words[0]));
                const double py = double(y) + double(unit_float(words[1]));
                FirstHit hit;
                const PathSample sample = kernel.trace(job.camera.ray(px, py), random, words[2],
                                                       wants_first_hit ? &hit : nullptr);
                if (is_finite(sample.direct) && is_finite(sample.indirect))
                    add_radiance(sample, sums);
                else
                    ++counts.discarded_samples;
                if (wants_first_hit && hit.found) add_first_hit(job, hit, px, py, sums);
            }
            write_pixel(job, x, y, sums);
        }
    counts.rays = counter.counts;
    return counts;
}

} // namespace detail

} // namespace ql
