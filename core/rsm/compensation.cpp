#include "rsm/compensation.h"

#include "render/path_kernel.h"

namespace ql {

Compensation::Compensation(const EmbreeScene& scene, const Gatherer& gatherer)
    : m_scene(scene), m_gatherer(gatherer) {}

V3f Compensation::returned(const ReflectiveShadowMap& map, const Receiver& receiver, const Ray& ray,
                           const Hit& hit, uint32_t alpha_key, CompensationCounts& counts) const {
    // See y from the light, if this map has it.
    const V3f y = ray.origin + ray.direction * hit.t;
    const auto at = map.projection.point(y);
    if (!at.is_inside()) return V3f(0);
    const Incidence incidence = incidence_at(map.light, y);
    if (incidence.irradiance == V3f(0, 0, 0)) return V3f(0);
    const RsmSurface surface = read_surface(m_scene.world(), ray, hit, incidence.to_light);
    const float cos_geometric = surface.ng.dot(incidence.to_light);
    const float cos_shading = surface.ns().dot(incidence.to_light);
    if (!(cos_geometric > 0) || !(cos_shading > 0) || !(surface.ng.dot(ray.direction) < 0))
        return V3f(0);

    // The part of G that the bound cuts off.
    const double texels = double(map.size) * double(map.size);
    const float radius2 = texel_radius2(map.projection.measure(at) / texels,
                                        map.projection.is_directional(), at.depth, cos_geometric);
    const float d2 = (surface.position - receiver.position).length2();
    const float share = 1 - d2 / m_gatherer.config().bound.divisor(d2, radius2);
    if (!(share > 0)) return V3f(0);

    // Is y lit?
    ++counts.shadow;
    const V3f origin = surface.position + surface.ng * surface.offset;
    if (m_scene.is_occluded(incidence.shadow_ray(origin), alpha_key)) return V3f(0);
    return detail::times(incidence.irradiance, diffuse_albedo(surface)) * (cos_shading * share);
}

V3f Compensation::irradiance(const Receiver& receiver, const PixelRandom& random,
                             CompensationCounts& counts) const {
    const AliasTable& maps = m_gatherer.map_table();
    if (maps.empty()) return V3f(0);
    const RandomWords words = random.words(1);
    const RandomFloats u = random.block(2);
    const V3f direction =
        frame_from_normal(receiver.ns).world_from_local(square_to_cosine_hemisphere({u[0], u[1]}));
    if (!(direction.dot(receiver.ng) > 0)) return V3f(0);
    const Ray ray{receiver.position + receiver.ng * receiver.offset, 0, direction, kInfinity};
    Hit hit;
    ++counts.nearest;
    if (!m_scene.intersect(ray, words[2], hit)) return V3f(0);
    const DiscreteSample pick = maps.sample(unit_double(words[0], words[1]));
    // E by cosine sampling is pi times the radiance, which is 1/pi times what y reflects.
    return returned(m_gatherer.maps()[pick.index], receiver, ray, hit, words[3], counts) /
           pick.probability;
}

} // namespace ql
