#include "render/path_tracer.h"

#include "base/check.h"
#include "render/frame_tiles.h"

namespace ql {

namespace detail {

void add_first_hit(const FrameJob& job, const FirstHit& hit, double x, double y, PixelSums& sums) {
    const World& world = job.scene.world();
    const V3d position = world.space.to_world(V3d(hit.position));
    ++sums.hits;
    sums.id = hit.surface + 1;
    sums.normal += V3d(hit.normal);
    sums.albedo += V3d(hit.albedo);
    sums.position += position;
    sums.depth += job.camera.depth(position);
    if (!job.film.motion_x) return;
    const int node = world.surfaces[hit.surface].node;
    const V3d moved =
        job.next_from_now.empty() ? position : job.next_from_now[size_t(node)].point(position);
    const auto there = job.next->camera.project(moved);
    if (!(there.depth > 0) || !std::isfinite(there.x) || !std::isfinite(there.y)) return;
    ++sums.moved;
    sums.motion_x += there.x - x;
    sums.motion_y += there.y - y;
}

void write_pixel(const FrameJob& job, int x, int y, const PixelSums& sums) {
    Film& film = job.film;
    const double real = std::ldexp(1.0, job.context.lights.exponent());
    const double n = std::max(sums.samples, 1);
    const V3d direct = sums.direct * (real / n);
    const V3d indirect = sums.indirect * (real / n);
    film.beauty.set(x, y, direct + indirect);
    if (film.direct) film.direct.set(x, y, direct);
    if (film.indirect) film.indirect.set(x, y, indirect);
    if (film.variance) {
        V3d variance(0);
        const V3d mean = (sums.direct + sums.indirect) / n;
        for (int i = 0; i < 3 && sums.samples > 1; ++i)
            variance[i] =
                std::max(0.0, sums.squares[i] / n - mean[i] * mean[i]) / (n - 1) * real * real;
        film.variance.set(x, y, variance);
    }
    const double hits = std::max(sums.hits, 1), moved = std::max(sums.moved, 1);
    if (film.normal) film.normal.set(x, y, sums.normal / hits);
    if (film.position) film.position.set(x, y, sums.position / hits);
    if (film.albedo) film.albedo.set(x, y, sums.albedo / hits);
    if (film.depth) (*film.depth)(x, y) = saturated(sums.depth / hits);
    if (film.motion_x) (*film.motion_x)(x, y) = saturated(sums.motion_x / moved);
    if (film.motion_y) (*film.motion_y)(x, y) = saturated(sums.motion_y / moved);
    if (film.id) (*film.id)(x, y) = sums.id;
}

} // namespace detail

namespace {

std::vector<Affine> motions(const World& world, const NextFrame* next) {
    std::vector<Affine> result;
    if (!next || next->world_from_node.empty()) return result;
    for (size_t i = 0; i < world.world_from_node.size(); ++i)
        result.push_back(compose(affine_from(next->world_from_node[i]),
                                 inverse(affine_from(world.world_from_node[i]))));
    return result;
}

PathContext path_context(const PosedScene& scene, const PathConfig& config) {
    const bool emission = has_emission(*scene.world().scene);
    const bool sky = config.sky != V3f(0, 0, 0);
    return {scene.rays(), scene.lights(), config, emission, emission || sky};
}

TileRenderer tile_renderer_for(const KernelChoice& choice) {
    return choice.lobes == kLobeDiffuse ? diffuse_tile_renderer() : general_tile_renderer();
}

} // namespace

KernelChoice choose_kernel(const Scene& scene) {
    uint32_t needed = 0;
    for (const Material& material : scene.materials)
        needed |= lobes_of(material);
    if ((needed & ~uint32_t(kLobeDiffuse)) == 0) return {kLobeDiffuse, "diffuse"};
    return {kAllLobes, "all lobes"};
}

FrameResult render_frame(const PosedScene& scene, const PixelCamera& camera,
                         const Array2D<uint32_t>& seeds, const RenderConfig& config,
                         const NextFrame* next, const Workers& workers, Progress& progress) {
    QL_CHECK(config.spp >= 1 && config.path.max_depth >= 1);
    QL_CHECK(!(config.aovs & kAovMotion) || next);
    const Scene& source = *scene.world().scene;
    Film film(seeds.width(), seeds.height(), config.aovs);
    const std::vector<Affine> next_from_now = motions(scene.world(), next);
    const FrameJob job{
        scene, camera, seeds, config, next, next_from_now, path_context(scene, config.path), film};
    const TileRenderer render_tile =
        config.dither ? dithered_tile_renderer() : tile_renderer_for(choose_kernel(source));
    const size_t across = size_t((seeds.width() + kTileSize - 1) / kTileSize);
    const size_t down = size_t((seeds.height() + kTileSize - 1) / kTileSize);
    std::vector<TileCounts> counts(across * down);
    progress.start("rendering", counts.size());
    workers.for_each(counts.size(), [&](size_t tile) {
        counts[tile] = render_tile(job, tile);
        progress.advance();
    });
    progress.finish();
    FrameResult result;
    for (const TileCounts& tile : counts) {
        result.rays.add(tile.rays);
        result.discarded_samples += tile.discarded_samples;
    }
    result.image = std::move(film.image);
    return result;
}

Metadata camera_metadata(const PixelCamera& camera) {
    return {{"worldToCamera", camera.world_to_camera()}, {"worldToNDC", camera.world_to_ndc()}};
}

} // namespace ql
