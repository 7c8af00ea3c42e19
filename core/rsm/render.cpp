#include "rsm/render.h"

#include "base/check.h"
#include "render/path_tracer.h"
#include "rsm/interpolation.h"

#include <chrono>
#include <cmath>

namespace ql {

namespace {

constexpr int kTilePixels = 16;

// All that the pixels of a pass share.
struct PassJob {
    const PosedScene& scene;
    const PixelCamera& camera;
    const RsmConfig& config;
    std::span<const MapLight> lights;
    const Gatherer& gatherer;
    const Compensation& compensation;
    const PassSamples& samples;
    ShiftSource shifts;
    PixelSumImage& sums;
    uint32_t pass;
};

struct TileState {
    RsmCounts counts;
    ShadowLog log;
    std::vector<Ray> rays; // RayMeasure::on
};

// One pixel of a pass before its gather.
struct PixelHit {
    bool found = false;
    RsmSurface surface;
    Receiver receiver;
    uint32_t alpha_key = 0;
    PixelRandom random{0, 0};
};

bool is_finite(const V3f& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

PixelHit first_hit(const PassJob& job, int x, int y, RsmCounts& counts) {
    PixelHit pixel;
    pixel.random =
        PixelRandom(hash32(job.config.seed, uint32_t(x), uint32_t(y), job.config.frame), job.pass);
    const RandomWords words = pixel.random.words(0);
    pixel.alpha_key = words[2];
    const bool jittered = job.config.pixel == PixelPoint::jittered;
    const double px = x + (jittered ? double(unit_float(words[0])) : 0.5);
    const double py = y + (jittered ? double(unit_float(words[1])) : 0.5);
    const Ray ray = job.camera.ray(px, py);
    Hit hit;
    ++counts.camera;
    pixel.found = job.scene.rays().intersect(ray, pixel.alpha_key, hit);
    if (!pixel.found) return pixel;
    pixel.surface = read_surface(job.scene.world(), ray, hit, -ray.direction);
    pixel.receiver = {pixel.surface.position, pixel.surface.ng, pixel.surface.ns(),
                      pixel.surface.offset};
    return pixel;
}

bool needs_gather(const PixelHit& pixel) {
    return pixel.found && (pixel.surface.bsdf.lobes & kLobeDiffuse);
}

using Clock = std::chrono::steady_clock;

uint64_t nanoseconds_since(Clock::time_point begin) {
    return uint64_t(
        std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now() - begin).count());
}

void trace_alone(const PassJob& job, TileState& state) {
    const auto begin = Clock::now();
    for (const Ray& ray : state.rays)
        job.scene.rays().is_occluded(ray, 0);
    state.counts.bare_ns += nanoseconds_since(begin);
    state.rays.clear();
}

V3f gathered(const PassJob& job, const PixelHit& pixel, int x, int y, TileState& state) {
    const auto gather = [&](ShadowLog& log) {
        return job.gatherer.irradiance(pixel.receiver, job.samples,
                                       job.shifts.place(x, y, job.pass),
                                       pixel.alpha_key ^ 0x5bd1e995u, log);
    };
    if (job.config.measure == RayMeasure::off) return gather(state.log);
    // Gather again for the rays: what it costs to keep them is not that of the gather.
    constexpr size_t kEnoughRays = 1 << 14;
    const auto begin = Clock::now();
    const V3f irradiance = gather(state.log);
    state.counts.gather_ns += nanoseconds_since(begin);
    ShadowLog again{0, &state.rays};
    gather(again);
    if (state.rays.size() > kEnoughRays) trace_alone(job, state);
    return irradiance;
}

// Adds direct light and the reflected irradiance, and hands the pixel to the sums.
void finish_pixel(const PassJob& job, const PixelHit& pixel, V3f irradiance, int x, int y,
                  TileState& state) {
    PixelPass out;
    if (pixel.found) {
        const RsmSurface& surface = pixel.surface;
        out.hit = true;
        out.position = surface.position;
        out.normal = surface.ns();
        out.albedo = albedo_of(surface.bsdf);
        out.surface = surface.surface;
        out.direct = job.config.direct == DirectMode::ray
                         ? direct_by_rays(job.scene.rays(), job.lights, surface, pixel.alpha_key,
                                          state.counts.direct_shadow)
                         : direct_by_maps(job.gatherer.maps(), surface);
        out.direct += surface.emission * job.scene.lights().stored_from_real();
        if (needs_gather(pixel)) {
            if (job.config.compensate == Compensate::yes) {
                CompensationCounts counts;
                irradiance += job.compensation.irradiance(pixel.receiver, pixel.random, counts);
                state.counts.compensation += counts.nearest;
                state.counts.compensation_shadow += counts.shadow;
            }
            // Listing 4 of Nilles 2017 adds what it gathers to the pixel as it is.
            out.indirect = job.config.gather.weights == PatternWeights::thesis
                               ? irradiance
                               : detail::times(diffuse_albedo(surface), irradiance) * kInvPi;
        }
    }
    if (!is_finite(out.direct) || !is_finite(out.indirect)) {
        ++state.counts.discarded_samples;
        return;
    }
    job.sums.add(x, y, out, job.scene.world().space, job.camera);
}

struct TileBounds {
    int x0, y0, x1, y1; // [x0, x1) x [y0, y1)
};

void render_tile(const PassJob& job, const TileBounds& tile, TileState& state) {
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const PixelHit pixel = first_hit(job, x, y, state.counts);
            V3f irradiance(0);
            if (needs_gather(pixel)) {
                ++state.counts.lit_pixels;
                irradiance = gathered(job, pixel, x, y, state);
            }
            finish_pixel(job, pixel, irradiance, x, y, state);
        }
}

// Gathers at the grid pixels in and around the tile, then interpolates the others. Tiles share
// grid pixels with their neighbours and find the same values there.
void render_tile_interpolated(const PassJob& job, const TileBounds& tile, TileState& state) {
    const int step = job.config.interpolate;
    const int across = (tile.x1 - tile.x0 + step - 1) / step + 1;
    const int down = (tile.y1 - tile.y0 + step - 1) / step + 1;
    Array2D<GridIrradiance> grid(across, down);
    for (int j = 0; j < down; ++j)
        for (int i = 0; i < across; ++i) {
            const int x = tile.x0 + i * step, y = tile.y0 + j * step;
            if (x >= job.sums.width() || y >= job.sums.height()) continue;
            const PixelHit pixel = first_hit(job, x, y, state.counts);
            if (!needs_gather(pixel)) continue;
            grid(i, j) = {true, pixel.receiver, gathered(job, pixel, x, y, state)};
        }
    for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
            const PixelHit pixel = first_hit(job, x, y, state.counts);
            V3f irradiance(0);
            if (needs_gather(pixel)) {
                ++state.counts.lit_pixels;
                const int i = (x - tile.x0) / step, j = (y - tile.y0) / step;
                const int dx = (x - tile.x0) % step, dy = (y - tile.y0) % step;
                const GridIrradiance* const corners[4] = {&grid(i, j), &grid(i + 1, j),
                                                          &grid(i, j + 1), &grid(i + 1, j + 1)};
                const auto found = interpolated_irradiance(
                    pixel.receiver, corners, float(dx) / float(step), float(dy) / float(step));
                if (dx == 0 && dy == 0)
                    irradiance = corners[0]->irradiance;
                else if (found)
                    irradiance = *found;
                else
                    irradiance = gathered(job, pixel, x, y, state);
                state.counts.interpolated_pixels += (dx || dy) && found ? 1 : 0;
            }
            finish_pixel(job, pixel, irradiance, x, y, state);
        }
}

} // namespace

void RsmCounts::add(const RsmCounts& other) {
    camera += other.camera;
    direct_shadow += other.direct_shadow;
    gather_shadow += other.gather_shadow;
    compensation += other.compensation;
    compensation_shadow += other.compensation_shadow;
    map += other.map;
    lit_pixels += other.lit_pixels;
    interpolated_pixels += other.interpolated_pixels;
    discarded_samples += other.discarded_samples;
    gather_ns += other.gather_ns;
    bare_ns += other.bare_ns;
}

RsmRenderer::RsmRenderer(const PosedScene& scene, const PixelCamera& camera, int width, int height,
                         const RsmConfig& config, const Workers& workers, Progress& progress)
    : m_scene(scene), m_camera(camera), m_config(config), m_workers(workers), m_progress(progress),
      m_lights(map_lights(scene)), m_sums(width, height, config.aovs) {
    QL_CHECK(config.interpolate >= 1 && config.interpolate <= 16);
    QL_CHECK(config.rotation != Rotation::blue || !config.mask.empty());
    QL_CHECK(!(config.aovs & kAovMotion));
    m_config.map.seed = frame_seed();
}

uint64_t RsmRenderer::frame_seed() const {
    const uint64_t seed = m_config.seed;
    const RandomWords words =
        philox4x32({m_config.frame, 0x72736d66, 0, 0}, {uint32_t(seed), uint32_t(seed >> 32)});
    return uint64_t{words[0]} << 32 | words[1];
}

void RsmRenderer::prepare_pass() {
    const GatherConfig& gather = m_config.gather;
    if (gather.gather == Gather::pattern)
        m_samples = pattern_samples(gather.samples, frame_seed(), uint32_t(m_passes));
    if (gather.gather == Gather::importance)
        m_samples = importance_samples(gather.samples, frame_seed(), uint32_t(m_passes));
    if (m_gatherer && m_config.map.point == TexelPoint::centre) return;
    m_gatherer.reset();
    m_config.map.pass = uint32_t(m_passes);
    m_maps = trace_maps(m_scene, m_lights, m_config.map, m_workers, m_progress);
    for (const ReflectiveShadowMap& map : m_maps)
        m_counts.map += map.texels.count();
    m_gatherer.emplace(m_scene.rays(), m_maps, gather);
}

void RsmRenderer::render_pass() {
    QL_CHECK(m_gatherer.has_value());
    const Compensation compensation(m_scene.rays(), *m_gatherer);
    const PassJob job{m_scene,     m_camera,
                      m_config,    m_lights,
                      *m_gatherer, compensation,
                      m_samples,   {m_config.rotation, &m_config.mask, frame_seed()},
                      m_sums,      uint32_t(m_passes)};
    // Tiles are a multiple of the interpolation grid.
    const int step = m_config.interpolate;
    const int side = step * std::max(1, kTilePixels / step);
    const int across = (m_sums.width() + side - 1) / side;
    const int down = (m_sums.height() + side - 1) / side;
    std::vector<TileState> states(size_t(across) * size_t(down));
    m_progress.start(fmt::format("pass {}", m_passes + 1), states.size());
    m_workers.for_each(states.size(), [&](size_t tile) {
        const int x0 = int(tile % size_t(across)) * side, y0 = int(tile / size_t(across)) * side;
        const TileBounds bounds{x0, y0, std::min(x0 + side, m_sums.width()),
                                std::min(y0 + side, m_sums.height())};
        if (step > 1)
            render_tile_interpolated(job, bounds, states[tile]);
        else
            render_tile(job, bounds, states[tile]);
        trace_alone(job, states[tile]);
        m_progress.advance();
    });
    m_progress.finish();
    for (TileState& state : states) {
        state.counts.gather_shadow = state.log.count;
        m_counts.add(state.counts);
    }
    ++m_passes;
}

Image RsmRenderer::image() const {
    return m_sums.image(m_scene.lights().exponent());
}

} // namespace ql
