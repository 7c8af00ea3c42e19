// A vertex of a camera path or a light path: where, seen from where, and how it scatters.
#pragma once

#include "sampling/warp.h"
#include "shading/surface_input.h"

namespace ql {

struct PathVertex {
    V3f position;
    float offset; // how far rays start off the surface, see offset_origin
    V3f ng;       // unit geometric normal towards where the path came from
    V3f wo;
    V3f wo_local;
    Frame frame; // around the shading normal
    Bsdf bsdf;
};

namespace detail {

// A shading normal may face away from the viewer; bend it until the viewer is just above. The
// geometric normal never needs it.
inline V3f facing_normal(const V3f& ns, const V3f& ng, const V3f& wo) {
    constexpr float kLeastCosine = 1e-3f;
    const float cosine = ns.dot(wo);
    if (cosine >= kLeastCosine || ns == ng) [[likely]]
        return ns;
    return (ns + wo * (kLeastCosine - cosine)).normalized();
}

} // namespace detail

// wo: unit, points away from the surface to where the path came from.
inline PathVertex path_vertex(const Scene& scene, const SurfacePoint& point,
                              const Material& material, const V3f& wo) {
    const std::span<const Texture> textures = scene.textures;
    const SurfaceInput input = surface_input(point, wo);
    prefetch_textures(textures, material, input);
    V3f ns = shading_normal(textures, material, input, point.ns, point.tangent);
    V3f ng = point.ng;
    if (!input.front) {
        ng = -ng;
        ns = -ns;
    }
    const Frame frame = frame_from_normal(detail::facing_normal(ns, ng, wo));
    return {point.position,
            point.offset,
            ng,
            wo,
            frame.local_from_world(wo),
            frame,
            bsdf_at(textures, material, input)};
}

} // namespace ql
