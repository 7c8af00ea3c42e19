#include "shading/shape_light.h"

#include "geometry/quadric.h"

#include <cmath>

namespace ql {

namespace {

// Points per side of the square over which the area of a stretched shape is summed up.
constexpr int kAreaPoints = 64;

V3d row(const Imath::M33d& m, int i) {
    return {m[i][0], m[i][1], m[i][2]};
}

// The transposed matrix times v.
V3d transposed_times(const Imath::M33d& m, const V3d& v) {
    return row(m, 0) * v.x + row(m, 1) * v.y + row(m, 2) * v.z;
}

} // namespace

ShapeLight::ShapeLight(const World& world, uint32_t surface) : m_world(&world), m_surface(surface) {
    const Surface& s = surface_of();
    const Imath::M33d& m = s.render_from_body.linear;
    m_area_of_body = shape_area(*s.implicit);
    m_determinant = std::abs(row(m, 0).dot(row(m, 1).cross(row(m, 2))));
    if (!(m_area_of_body > 0) || !(m_determinant > 0)) return;
    for (int i = 0; i < kAreaPoints; ++i)
        for (int j = 0; j < kAreaPoints; ++j) {
            const ShapePoint point =
                sample({(float(i) + 0.5f) / kAreaPoints, (float(j) + 0.5f) / kAreaPoints});
            m_area += area_at(V3d(point.normal)) / (kAreaPoints * kAreaPoints);
        }
}

ShapePoint ShapeLight::sample(V2f u) const {
    const Surface& s = surface_of();
    const BodyPoint p = uniform_point(*s.implicit, double(u.x), double(u.y));
    const V3d normal = transposed_times(s.body_from_render.linear, p.normal).normalized();
    return {V3f(s.render_from_body.point(p.position)), V3f(normal), p.uv};
}

// An area with normal n shrinks by |det M| |M^-T n| from render space to the body's, M being
// render_from_body; M^-T n is along the normal in the body's space.
double ShapeLight::area_at(const V3d& normal) const {
    return m_area_of_body * m_determinant /
           transposed_times(surface_of().render_from_body.linear, normal).length();
}

float ShapeLight::area_at(const V3f& normal) const {
    return float(area_at(V3d(normal)));
}

} // namespace ql
