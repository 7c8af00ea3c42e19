#include "rsm/light.h"

#include <cmath>

namespace ql {

namespace {

// As in LightSet: a light inside the last 2^-20 of the way may lie on a surface.
constexpr float kShadowEnd = 1 - 0x1p-20f;

std::string name_of(const Scene& scene, const Node& node, size_t number) {
    const std::string& own = scene.lights[size_t(node.light)].name;
    if (!own.empty()) return own;
    return node.name.empty() ? std::to_string(number) : node.name;
}

bool shines(const MapLight& light) {
    const bool has_cone = light.kind != Light::Kind::spot || light.outer_angle > 0;
    const bool has_axis = light.kind == Light::Kind::point || light.axis.length2() > 0.5f;
    return light.intensity != V3f(0, 0, 0) && has_cone && has_axis;
}

} // namespace

std::vector<MapLight> map_lights(const PosedScene& posed) {
    const World& world = posed.world();
    const Scene& scene = *world.scene;
    const double stored_from_real = std::ldexp(1.0, -posed.lights().exponent());
    std::vector<MapLight> lights;
    size_t number = 0;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        if (scene.nodes[i].light < 0) continue;
        const Light& source = scene.lights[size_t(scene.nodes[i].light)];
        const Affine world_from_node = affine_from(world.world_from_node[i]);
        const double per_area =
            source.kind == Light::Kind::directional ? 1 : world.space.scale * world.space.scale;
        MapLight light;
        light.name = name_of(scene, scene.nodes[i], number++);
        light.kind = source.kind;
        light.position = V3f(world.space.from_world(world_from_node.translation));
        light.axis = V3f(world_from_node.vector({0, 0, -1}).normalized());
        light.intensity = V3f(source.intensity * (per_area * stored_from_real));
        light.outer_angle = source.outer_angle;
        light.cone =
            spot_cone(source.inner_angle, source.outer_angle, source.exponent.value_or(-1));
        if (shines(light)) lights.push_back(light);
    }
    return lights;
}

V3f intensity_towards(const MapLight& light, const V3f& direction) {
    if (light.kind != Light::Kind::spot) return light.intensity;
    return light.intensity * light.cone.falloff(one_minus_cos_between(direction, light.axis));
}

Incidence incidence_at(const MapLight& light, const V3f& point) {
    Incidence incidence;
    if (light.kind == Light::Kind::directional) {
        incidence.to_light = -light.axis;
        incidence.distant = true;
        incidence.irradiance = light.intensity;
        return incidence;
    }
    const V3f way = light.position - point;
    const float distance2 = way.dot(way);
    if (!(distance2 > 0)) return incidence;
    incidence.to_light = way / std::sqrt(distance2);
    incidence.target = point + way * kShadowEnd;
    incidence.irradiance = intensity_towards(light, -incidence.to_light) / distance2;
    return incidence;
}

Ray Incidence::shadow_ray(const V3f& origin) const {
    if (distant) return {origin, 0, to_light, kInfinity};
    return {origin, 0, target - origin, 1};
}

} // namespace ql
