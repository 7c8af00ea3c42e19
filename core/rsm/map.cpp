#include "rsm/map.h"

#include "base/check.h"
#include "sampling/random.h"

#include <cmath>
#include <numbers>

namespace ql {

namespace {

// At grazing angles a texel covers ever more; the cosine stops here.
constexpr float kLeastCosine = 1e-3f;
// Separates the random numbers of the maps from those of the gathers.
constexpr uint64_t kMapKey = 0x52534d6d61700000;

struct MapJob {
    const PosedScene& scene;
    const MapConfig& config;
    ReflectiveShadowMap& map;
    uint32_t number; // of the map
};

void set_texel(const MapJob& job, size_t i, const MapProjection::LightRay& view, const Hit& hit) {
    const V3f to_light = -view.ray.direction;
    const RsmSurface surface = read_surface(job.scene.world(), view.ray, hit, to_light);
    const float cos_shading = surface.ns().dot(to_light);
    const float cos_geometric = surface.ng.dot(to_light);
    Texels& t = job.map.texels;
    t.px[i] = surface.position.x;
    t.py[i] = surface.position.y;
    t.pz[i] = surface.position.z;
    t.nx[i] = surface.ng.x;
    t.ny[i] = surface.ng.y;
    t.nz[i] = surface.ng.z;
    t.offset[i] = surface.offset;
    t.depth[i] = hit.t;
    const int size = job.map.size;
    const double measure = view.measure / double(size) / double(size);
    t.radius2[i] =
        texel_radius2(measure, job.map.projection.is_directional(), hit.t, cos_geometric);
    if (!(cos_geometric > 0) || !(cos_shading > 0)) return;
    const float share = job.config.measure == FluxMeasure::watts
                            ? float(measure) * (cos_shading / cos_geometric)
                            : 1.0f;
    const V3f intensity = intensity_towards(job.map.light, view.ray.direction);
    const V3f albedo = diffuse_albedo(surface);
    t.red[i] = intensity.x * albedo.x * share;
    t.green[i] = intensity.y * albedo.y * share;
    t.blue[i] = intensity.z * albedo.z * share;
}

void trace_row(const MapJob& job, int y) {
    const int size = job.map.size;
    for (int x = 0; x < size; ++x) {
        const size_t i = size_t(y) * size_t(size) + size_t(x);
        const CounterRandom random(job.config.seed ^ kMapKey, uint64_t{job.config.pass} << 32 | i);
        const RandomWords words = random.words(job.number);
        const bool jittered = job.config.point == TexelPoint::jittered;
        const double du = jittered ? double(unit_float(words[0])) : 0.5;
        const double dv = jittered ? double(unit_float(words[1])) : 0.5;
        const auto view = job.map.projection.ray((x + du) / size, (y + dv) / size);
        Hit hit;
        if (job.scene.rays().intersect(view.ray, words[2], hit)) set_texel(job, i, view, hit);
    }
}

void add_up(ReflectiveShadowMap& map) {
    const Texels& t = map.texels;
    for (size_t i = 0; i < t.count(); ++i) {
        const V3f flux = t.flux(i);
        map.flux += V3d(flux);
        map.lit_texels += flux != V3f(0, 0, 0) ? 1 : 0;
    }
}

} // namespace

Texels::Texels(size_t count)
    : px(count), py(count), pz(count), nx(count), ny(count), nz(count), red(count), green(count),
      blue(count), radius2(count), offset(count), depth(count, kInfinity) {}

size_t map_bytes(int size) {
    return size_t(size) * size_t(size) * 150;
}

int64_t ReflectiveShadowMap::texel_at(float u, float v) const {
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1)) return -1;
    const int x = std::min(int(u * float(size)), size - 1);
    const int y = std::min(int(v * float(size)), size - 1);
    return int64_t(y) * size + x;
}

float texel_radius2(double texel_measure, bool is_directional, float distance, float cos_light) {
    const double d2 = is_directional ? 1.0 : double(distance) * double(distance);
    return float(texel_measure * d2 /
                 (double(std::max(cos_light, kLeastCosine)) * std::numbers::pi));
}

std::vector<ReflectiveShadowMap> trace_maps(const PosedScene& scene,
                                            const std::vector<MapLight>& lights,
                                            const MapConfig& config, const Workers& workers,
                                            Progress& progress) {
    QL_CHECK(config.size >= 1 && config.size <= 16384);
    std::vector<ReflectiveShadowMap> maps;
    for (const MapLight& light : lights) {
        const auto projections = map_projections(light, config.kind, scene.world());
        for (size_t face = 0; face < projections.size(); ++face) {
            const std::string suffix = projections.size() > 1 ? fmt::format(".face{}", face) : "";
            maps.push_back({light.name + suffix, light, projections[face], config.size,
                            Texels(size_t(config.size) * size_t(config.size)), 0, V3d(0)});
        }
    }
    progress.start("tracing maps", maps.size() * size_t(config.size));
    for (uint32_t number = 0; number < maps.size(); ++number) {
        const MapJob job{scene, config, maps[number], number};
        workers.for_each(size_t(config.size), [&](size_t y) {
            trace_row(job, int(y));
            progress.advance();
        });
        add_up(maps[number]);
    }
    progress.finish();
    return maps;
}

} // namespace ql
