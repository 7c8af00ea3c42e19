#include "rsm/surface.h"

#include "render/path_kernel.h"
#include "shading/surface_input.h"

namespace ql {

namespace {

template<uint32_t Attributes>
RsmSurface read_surface(const World& world, const Ray& ray, const Hit& hit, const V3f& wo) {
    constexpr bool kTextured = (Attributes & kAttributeTextures) != 0;
    const SurfacePoint point = surface_point<Attributes>(world, ray, hit);
    const Material& material = world.scene->materials[size_t(point.material)];
    const SurfaceInput input = surface_input(point, wo);
    const std::span<const Texture> textures = world.scene->textures;
    V3f ns = shading_normal<kTextured>(textures, material, input, point.ns, point.tangent);
    V3f ng = point.ng;
    if (!input.front) {
        ng = -ng;
        ns = -ns;
    }
    if constexpr (Attributes != 0) ns = detail::facing_normal(ns, wo);
    RsmSurface surface;
    surface.position = point.position;
    surface.ng = ng;
    surface.offset = point.offset;
    surface.frame = frame_from_normal(ns);
    surface.wo_local = surface.frame.local_from_world(wo);
    surface.bsdf = bsdf_at<kTextured>(textures, material, input);
    surface.emission = emission_at<kTextured>(textures, material, input);
    surface.surface = point.surface;
    return surface;
}

} // namespace

SurfaceReader surface_reader(uint32_t attributes) {
    if (attributes & kAttributeTextures)
        return read_surface<kAttributeNormals | kAttributeTextures>;
    if (attributes & kAttributeNormals) return read_surface<kAttributeNormals>;
    return read_surface<0>;
}

V3f diffuse_albedo(const RsmSurface& surface) {
    const Bsdf& bsdf = surface.bsdf;
    if (!(bsdf.lobes & kLobeDiffuse)) return V3f(0);
    if (!(bsdf.lobes & kLobeMicrofacet)) return bsdf.diffuse;
    return bsdf.diffuse * (1 - dielectric_fresnel(surface.wo_local.z, relative_eta(bsdf)));
}

V3f scattered(const RsmSurface& surface, const V3f& wi) {
    return eval_bsdf<kAllLobes>(surface.bsdf, surface.wo_local, surface.frame.local_from_world(wi));
}

} // namespace ql
