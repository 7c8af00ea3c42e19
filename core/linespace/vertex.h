// A vertex of a light path or a camera path: where, seen from where, and how it scatters.
#pragma once

#include "render/path_kernel.h"

namespace ql {

struct PathVertex {
    V3f position;
    float offset;
    V3f ng; // unit geometric normal towards where the path came from
    V3f wo;
    V3f wo_local;
    Frame frame;
    Bsdf bsdf;
};

template<uint32_t Attributes>
PathVertex path_vertex(const World& world, const SurfacePoint& point, const Material& material,
                       const V3f& wo) {
    constexpr bool kTextured = (Attributes & kAttributeTextures) != 0;
    const std::span<const Texture> textures = world.scene->textures;
    const SurfaceInput input = surface_input(point, wo);
    V3f ns = shading_normal<kTextured>(textures, material, input, point.ns, point.tangent);
    V3f ng = point.ng;
    if (!input.front) {
        ng = -ng;
        ns = -ns;
    }
    if constexpr (Attributes != 0) ns = detail::facing_normal(ns, wo);
    ns += V3f(0); // no negative zeros: frames depend on the sign of z
    const Frame frame = frame_from_normal(ns);
    return {point.position,
            point.offset,
            ng,
            wo,
            frame.local_from_world(wo),
            frame,
            bsdf_at<kTextured>(textures, material, input)};
}

// Where rays into the half space of w start, in double precision: also the point that is looked up
// in the grid, so that walls belong to the voxel on the side that is lit.
inline V3d start_of(const PathVertex& vertex, const V3f& w) {
    return V3d(offset_origin(vertex.position, vertex.ng, vertex.offset, w));
}

// Whether points of this material ever take light from the cache; perfect mirrors and glass do not.
inline bool takes_light(const Material& material) {
    return (lobes_of(material) & (kLobeDiffuse | kLobePhong)) != 0;
}

} // namespace ql
