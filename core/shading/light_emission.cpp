#include "shading/light_emission.h"

#include "sampling/warp.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

float mean(const V3f& v) {
    return (v.x + v.y + v.z) / 3;
}

// h: 1 - cos of the angle from the axis.
V3f direction_at(const V3f& axis, double h, double turns) {
    const SinCos phi = sin_cos_turns(float(turns));
    const auto sine = float(std::sqrt(std::max(0.0, h * (2 - h))));
    return frame_from_normal(axis).world_from_local({sine * phi.cos, sine * phi.sin, float(1 - h)});
}

} // namespace

LightEmission::LightEmission(const LightSet& lights)
    : m_lights(lights), m_power(lights.empty() ? 0 : lights.m_pick.sum()) {
    for (const LightSet::Punctual& light : lights.m_punctual) {
        m_is_punctual &= light.kind != Light::Kind::directional;
        m_greatest_intensity = std::max(m_greatest_intensity, double(mean(light.intensity)));
    }
    for (size_t i = 0; i < lights.emitter_count(); ++i)
        m_is_punctual &= !(lights.m_pick.probability(lights.m_punctual.size() + i) > 0);
}

EmittedPhoton LightEmission::sample(double u_pick, V2f u_position, V2f u_direction) const {
    const DiscreteSample pick = m_lights.m_pick.sample(u_pick);
    EmittedPhoton photon;
    const size_t punctual = m_lights.m_punctual.size();
    const size_t triangles = m_lights.m_triangles.size();
    if (pick.index >= punctual + triangles) {
        photon = from_shape(m_lights.m_shapes[pick.index - punctual - triangles], u_position,
                            pick.u, u_direction);
    } else if (pick.index >= punctual) {
        photon = from_triangle(m_lights.m_triangles[pick.index - punctual], u_position, pick.u,
                               u_direction);
    } else {
        const LightSet::Punctual& light = m_lights.m_punctual[pick.index];
        switch (light.kind) {
        case Light::Kind::point:
            photon = from_point(light, u_direction);
            break;
        case Light::Kind::spot:
            photon = from_spot(light, u_direction);
            break;
        case Light::Kind::directional:
            photon = from_far(light, u_position);
            break;
        }
    }
    photon.flux *= float(1 / (double(pick.probability) * m_power));
    return photon;
}

EmittedPhoton LightEmission::from_point(const LightSet::Punctual& light, V2f u) const {
    return {light.position, square_to_uniform_sphere(u), light.intensity * (4 * kPi),
            light.intensity * float(1 / m_greatest_intensity)};
}

EmittedPhoton LightEmission::from_spot(const LightSet::Punctual& light, V2f u) const {
    const double h = std::clamp(light.cone.sample(double(u.x)), 0.0, 2.0);
    const float falloff = light.cone.falloff(float(h));
    return {light.position, direction_at(light.axis, h, double(u.y)),
            light.intensity * float(2 * double(kPi) * light.cone.integral()),
            light.intensity * float(double(falloff) / m_greatest_intensity)};
}

EmittedPhoton LightEmission::from_far(const LightSet::Punctual& light, V2f u) const {
    const Imath::Box3d& bounds = m_lights.m_world->bounds;
    const V3d size = bounds.isEmpty() ? V3d(0) : bounds.size();
    const auto radius = float(size.length() / 2);
    const V2f disc = square_to_uniform_disk(u) * radius;
    const Frame frame = frame_from_normal(light.axis);
    const V3f centre = bounds.isEmpty() ? V3f(0) : V3f(bounds.center());
    const V3f origin =
        centre + frame.s * disc.x + frame.t * disc.y - light.axis * (1.001f * radius);
    return {origin, light.axis, light.intensity * (kPi * radius * radius), V3f(0)};
}

namespace {

// From a point of an emitter, on one of its sides; flux is that of one side.
EmittedPhoton from_emitter(const V3f& at, const V3f& front, float offset, bool double_sided,
                           float u_side, V2f u_direction, const V3f& flux) {
    const V3f normal = double_sided && u_side < 0.5f ? -front : front;
    const V3f direction =
        frame_from_normal(normal).world_from_local(square_to_cosine_hemisphere(u_direction));
    return {offset_origin(at, front, offset, normal), direction,
            flux * (double_sided ? 2.0f : 1.0f), V3f(0)};
}

} // namespace

EmittedPhoton LightEmission::from_triangle(const LightSet::Triangle& light, V2f u_position,
                                           float u_side, V2f u_direction) const {
    const V2f b = square_to_uniform_triangle(u_position);
    return from_emitter(light.corner + light.edge1 * b.x + light.edge2 * b.y, light.normal,
                        light.offset, light.double_sided, u_side, u_direction,
                        m_lights.triangle_radiance(light, b.x, b.y) * (kPi * light.area));
}

EmittedPhoton LightEmission::from_shape(const ShapeLight& light, V2f u_position, float u_side,
                                        V2f u_direction) const {
    const ShapePoint point = light.sample(u_position);
    const Surface& surface = m_lights.m_world->surfaces[light.surface()];
    return from_emitter(point.position, point.normal, surface.offset,
                        m_lights.is_double_sided(light), u_side, u_direction,
                        m_lights.shape_radiance(light, point.uv) *
                            (kPi * light.area_at(point.normal)));
}

} // namespace ql
