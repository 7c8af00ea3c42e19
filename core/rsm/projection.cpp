#include "rsm/projection.h"

#include "base/error.h"
#include "sampling/warp.h"

#include <array>
#include <cmath>
#include <numbers>

namespace ql {

namespace {

constexpr double kPiD = std::numbers::pi;
// Beyond it a perspective map spends nearly all its texels on the rim of the cone.
constexpr double kMaxPerspectiveAngle = 89.5 / 180 * kPiD;
// As shadow rays end that far before a light, so do rays from the light begin: a light may lie on
// a surface. The longest way through the scene is sqrt(3).
constexpr float kLightClearance = 0x1p-20f;

std::array<V3f, 3> view_axes(const V3f& forward) {
    const V3f hint = std::abs(forward.y) > 0.9999f ? V3f(0, 0, 1) : V3f(0, 1, 0);
    const V3f right = forward.cross(hint).normalized();
    return {right, right.cross(forward), forward};
}

} // namespace

MapProjection::LightRay MapProjection::ray(double u, double v) const {
    const double x = 2 * u - 1;
    const double y = 1 - 2 * v;
    LightRay result{{m_origin, kLightClearance, m_forward, kInfinity}, 0};
    if (m_kind == Kind::orthographic) {
        result.ray.origin += m_right * float(x * m_half_width) + m_up * float(y * m_half_width);
        result.ray.t_near = 0;
        result.measure = 4 * m_half_width * m_half_width;
    } else if (m_kind == Kind::perspective) {
        const double sx = x * m_tangent, sy = y * m_tangent;
        const double cosine = 1 / std::sqrt(1 + sx * sx + sy * sy);
        result.ray.direction =
            m_right * float(sx * cosine) + m_up * float(sy * cosine) + m_forward * float(cosine);
        result.measure = cosine * cosine * cosine * 4 * m_tangent * m_tangent;
    } else {
        const V3f local = square_to_uniform_cone({float(u), float(1 - v)}, m_one_minus_cos);
        result.ray.direction = m_right * local.x + m_up * local.y + m_forward * local.z;
        result.measure = 2 * kPiD * double(m_one_minus_cos);
    }
    return result;
}

MapProjection::MapPoint MapProjection::point(const V3f& p) const {
    const V3f way = p - m_origin;
    const V3f local(m_right.dot(way), m_up.dot(way), m_forward.dot(way));
    MapPoint at;
    if (m_kind == Kind::orthographic) {
        const float half = float(m_half_width);
        at.uv = {(local.x / half + 1) / 2, (1 - local.y / half) / 2};
        at.depth = local.z;
        return at;
    }
    at.depth = local.length();
    if (!(at.depth > 0)) return at;
    if (m_kind == Kind::perspective) {
        at.is_ahead = local.z > 0;
        // What is behind goes to the border on its side.
        const float z = std::max(local.z, 1e-6f * at.depth) * float(m_tangent);
        at.uv = {(local.x / z + 1) / 2, (1 - local.y / z) / 2};
    } else {
        const V2f square = uniform_cone_to_square(local / at.depth, m_one_minus_cos);
        at.uv = {square.x, 1 - square.y};
    }
    return at;
}

double MapProjection::measure(const MapPoint& at) const {
    if (m_kind == Kind::orthographic) return 4 * m_half_width * m_half_width;
    if (m_kind == Kind::equal_area) return 2 * kPiD * double(m_one_minus_cos);
    const double sx = (2 * double(at.uv.x) - 1) * m_tangent;
    const double sy = (2 * double(at.uv.y) - 1) * m_tangent;
    return 4 * m_tangent * m_tangent * std::pow(1 + sx * sx + sy * sy, -1.5);
}

double MapProjection::reach(const MapPoint& at, double texels, int size) const {
    const double step = 2 * texels / size; // in a square of side 2
    if (m_kind == Kind::orthographic) return step * m_half_width;
    const double x = 2 * double(at.uv.x) - 1, y = 2 * double(at.uv.y) - 1;
    if (m_kind == Kind::perspective) {
        const double sx = x * m_tangent, sy = y * m_tangent;
        return step * m_tangent / std::sqrt(1 + sx * sx + sy * sy);
    }
    // The larger coordinate is the radius of the disc, whose points 1 - cos = scale r^2 are.
    const double scale = double(m_one_minus_cos);
    const auto angle_at = [&](double r) {
        return 2 * std::asin(std::min(1.0, std::sqrt(scale / 2) * std::clamp(r, 0.0, 1.0)));
    };
    const double r = std::max(std::abs(x), std::abs(y));
    const double across = r > 0 ? std::sin(angle_at(r)) / r : std::sqrt(2 * scale);
    return std::max(
        {angle_at(r + step) - angle_at(r), angle_at(r) - angle_at(r - step), step * across});
}

std::vector<MapProjection> map_projections(const MapLight& light, MapKind kind,
                                           const World& world) {
    using Kind = MapProjection::Kind;
    MapProjection projection;
    const bool has_axis = light.kind != Light::Kind::point;
    std::array<V3f, 3> axes = view_axes(has_axis ? light.axis : V3f(0, 0, -1));
    const auto turn = [&] {
        projection.m_right = axes[0];
        projection.m_up = axes[1];
        projection.m_forward = axes[2];
    };
    turn();
    projection.m_origin = light.position;

    if (light.kind == Light::Kind::directional) {
        // The square around the shadow of the bounds, from a plane in front of them.
        projection.m_kind = Kind::orthographic;
        const Imath::Box3d& bounds = world.bounds;
        double half = 0, front = 0;
        const V3d centre = bounds.isEmpty() ? V3d(0) : bounds.center();
        for (int corner = 0; corner < 8 && !bounds.isEmpty(); ++corner) {
            const V3d p = V3d(corner & 1 ? bounds.max.x : bounds.min.x,
                              corner & 2 ? bounds.max.y : bounds.min.y,
                              corner & 4 ? bounds.max.z : bounds.min.z) -
                          centre;
            half = std::max({half, std::abs(p.dot(V3d(axes[0]))), std::abs(p.dot(V3d(axes[1])))});
            front = std::max(front, -p.dot(V3d(axes[2])));
        }
        projection.m_half_width = half > 0 ? half : 1;
        projection.m_origin = V3f(centre - V3d(axes[2]) * (front + projection.m_half_width));
        return {projection};
    }
    if (kind == MapKind::equal_area) {
        projection.m_kind = Kind::equal_area;
        projection.m_one_minus_cos =
            has_axis ? std::min(2.0f, one_minus_cos(float(light.outer_angle))) : 2.0f;
        return {projection};
    }
    projection.m_kind = Kind::perspective;
    if (has_axis) {
        if (light.outer_angle > kMaxPerspectiveAngle)
            throw input_error("light {}: a cut-off of {:.3g} degrees, expected at most 89.5 with a "
                              "perspective map (an equal-area map holds it)",
                              light.name, light.outer_angle * 180 / kPiD);
        projection.m_tangent = std::tan(light.outer_angle);
        return {projection};
    }
    std::vector<MapProjection> faces;
    for (const V3f& forward :
         {V3f(1, 0, 0), V3f(-1, 0, 0), V3f(0, 1, 0), V3f(0, -1, 0), V3f(0, 0, 1), V3f(0, 0, -1)}) {
        axes = view_axes(forward);
        turn();
        faces.push_back(projection);
    }
    return faces;
}

} // namespace ql
