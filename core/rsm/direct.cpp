#include "rsm/direct.h"

#include "render/path_kernel.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

// The filter reaches 2 texels from the point, 2 sqrt(2) on the diagonal.
constexpr double kFilterReach = 2.83;
// Steeper than this slope the bias grows no more: the surface gets next to no light there.
constexpr double kMaxSlope = 50;
// Beside the slope: rounding of the depth.
constexpr double kDepthRounding = 1e-6;

// Light that the surface scatters to the viewer if nothing is in the way.
V3f unshadowed(const RsmSurface& surface, const Incidence& incidence) {
    const float geometric = surface.ng.dot(incidence.to_light);
    const float shading = surface.ns().dot(incidence.to_light);
    if (shading * geometric <= 0 || incidence.irradiance == V3f(0, 0, 0)) return V3f(0);
    return detail::times(scattered(surface, incidence.to_light), incidence.irradiance);
}

// The share of the filter's texels that are not nearer to the light than `depth`.
float lit_share(const ReflectiveShadowMap& map, const V2f& uv, float depth) {
    const float x = uv.x * float(map.size) - 0.5f, y = uv.y * float(map.size) - 0.5f;
    const int x0 = int(std::floor(x)) - 1, y0 = int(std::floor(y)) - 1;
    const float fx = x - std::floor(x), fy = y - std::floor(y);
    const float wx[4] = {1 - fx, 1, 1, fx}, wy[4] = {1 - fy, 1, 1, fy};
    float lit = 0;
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) {
            const int tx = std::clamp(x0 + i, 0, map.size - 1);
            const int ty = std::clamp(y0 + j, 0, map.size - 1);
            const size_t texel = size_t(ty) * size_t(map.size) + size_t(tx);
            if (depth <= map.texels.depth[texel]) lit += wx[i] * wy[j];
        }
    return lit / 9;
}

} // namespace

V3f direct_by_rays(const EmbreeScene& scene, std::span<const MapLight> lights,
                   const RsmSurface& surface, uint32_t alpha_key, uint64_t& shadow_rays) {
    V3f sum(0);
    for (size_t i = 0; i < lights.size(); ++i) {
        const Incidence incidence = incidence_at(lights[i], surface.position);
        const V3f radiance = unshadowed(surface, incidence);
        if (radiance == V3f(0, 0, 0)) continue;
        const Ray ray = incidence.shadow_ray(
            offset_origin(surface.position, surface.ng, surface.offset, incidence.to_light));
        ++shadow_rays;
        if (!scene.is_occluded(ray, alpha_key + uint32_t(i) * 0x85ebca6bu)) sum += radiance;
    }
    return sum;
}

V3f direct_by_maps(std::span<const ReflectiveShadowMap> maps, const RsmSurface& surface) {
    V3f sum(0);
    for (const ReflectiveShadowMap& map : maps) {
        const auto at = map.projection.point(surface.position);
        if (!at.is_inside()) continue;
        const Incidence incidence = incidence_at(map.light, surface.position);
        const V3f radiance = unshadowed(surface, incidence);
        if (radiance == V3f(0, 0, 0)) continue;
        const double cosine = std::abs(double(surface.ng.dot(incidence.to_light)));
        const double slope =
            std::min(kMaxSlope, std::sqrt(std::max(0.0, 1 - cosine * cosine)) / cosine);
        const double depth = double(at.depth);
        const double reach = map.projection.reach(at, kFilterReach, map.size);
        // Along a plane the depth of directions that far away grows by the slope, and by its
        // square.
        const double further =
            map.projection.is_directional()
                ? reach * slope
                : depth * (reach * slope + reach * reach * (0.5 + slope * slope));
        const double bias = further + kDepthRounding * (1 + depth);
        sum += radiance * lit_share(map, at.uv, float(depth - bias));
    }
    return sum;
}

} // namespace ql
