#include "rsm/surface.h"

#include "shading/vertex.h"

namespace ql {

RsmSurface read_surface(const World& world, const Ray& ray, const Hit& hit, const V3f& wo) {
    const SurfacePoint point = surface_point(world, ray, hit);
    const Material& material = world.scene->materials[size_t(point.material)];
    const PathVertex vertex = path_vertex(*world.scene, point, material, wo);
    RsmSurface surface;
    surface.position = vertex.position;
    surface.ng = vertex.ng;
    surface.offset = vertex.offset;
    surface.frame = vertex.frame;
    surface.wo_local = vertex.wo_local;
    surface.bsdf = vertex.bsdf;
    surface.emission = emission_at(world.scene->textures, material, surface_input(point, wo));
    surface.surface = point.surface;
    return surface;
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
