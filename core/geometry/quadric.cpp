#include "geometry/quadric.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ql {

namespace {

constexpr double kPi = std::numbers::pi;

struct Roots {
    double near, far;
};

// Roots of a t^2 + 2 b t + c in rising order, without cancellation.
std::optional<Roots> quadratic_roots(double a, double b, double c) {
    const double discriminant = b * b - a * c;
    if (!(discriminant >= 0) || a == 0) return std::nullopt;
    const double q = -(b + std::copysign(std::sqrt(discriminant), b));
    const double t0 = q / a;
    const double t1 = q != 0 ? c / q : t0;
    return Roots{std::min(t0, t1), std::max(t0, t1)};
}

float turn(double x, double z) {
    return float(std::atan2(z, x) / (2 * kPi) + 0.5);
}

std::optional<QuadricHit> intersect_sphere(const ImplicitShape& shape, const V3d& origin,
                                           const V3d& direction, double t_near, double t_far) {
    // Move the origin to the point of the line nearest to the centre: from far away the plain
    // discriminant loses all its digits.
    const double d2 = direction.dot(direction);
    const double t_closest = -origin.dot(direction) / d2;
    const V3d closest = origin + direction * t_closest;
    const double r = double(shape.radius);
    const double half_chord2 = (r * r - closest.dot(closest)) / d2;
    if (!(half_chord2 >= 0)) return std::nullopt;
    const double half_chord = std::sqrt(half_chord2);
    for (const double t : {t_closest - half_chord, t_closest + half_chord}) {
        if (!(t > t_near && t < t_far)) continue;
        const V3d normal = (origin + direction * t).normalized();
        const double latitude = std::acos(std::clamp(normal.y, -1.0, 1.0)) / kPi;
        return QuadricHit{t, normal, {turn(normal.x, normal.z), float(latitude)}};
    }
    return std::nullopt;
}

struct ConeProfile {
    double half_height, bottom, slope; // radius at y: bottom + slope (y + half_height)
    double radius(double y) const { return bottom + slope * (y + half_height); }
};

ConeProfile profile_of(const ImplicitShape& shape) {
    const double height = double(shape.height);
    return {height / 2, double(shape.radius_bottom),
            (double(shape.radius_top) - double(shape.radius_bottom)) / height};
}

struct ConeAreas {
    double side, bottom, top;
};

ConeAreas areas_of(const ImplicitShape& shape) {
    const double b = double(shape.radius_bottom), t = double(shape.radius_top);
    return {kPi * (b + t) * std::hypot(double(shape.height), b - t), kPi * b * b, kPi * t * t};
}

// Side of the cone: x^2 + z^2 = radius(y)^2, |y| <= half_height.
void intersect_side(const ConeProfile& cone, const V3d& o, const V3d& d, double t_near,
                    double t_far, std::optional<QuadricHit>& nearest) {
    const double k = cone.slope;
    const double r0 = cone.radius(o.y);
    const double a = d.x * d.x + d.z * d.z - k * k * d.y * d.y;
    const double b = o.x * d.x + o.z * d.z - k * r0 * d.y;
    const double c = o.x * o.x + o.z * o.z - r0 * r0;
    // Along a line of the cone itself the quadratic degenerates to 2 b t + c = 0.
    const double scale = d.dot(d);
    std::optional<Roots> roots;
    if (std::abs(a) > 1e-14 * scale)
        roots = quadratic_roots(a, b, c);
    else if (b != 0)
        roots = Roots{-c / (2 * b), -c / (2 * b)};
    if (!roots) return;
    for (const double t : {roots->near, roots->far}) {
        const V3d p = o + d * t;
        if (!(t > t_near && t < t_far) || std::abs(p.y) > cone.half_height) continue;
        if (cone.radius(p.y) < 0 || (nearest && nearest->t <= t)) continue;
        const double ring = std::hypot(p.x, p.z);
        const V3d outward = ring > 0 ? V3d(p.x / ring, -k, p.z / ring) : V3d(0, k > 0 ? -1 : 1, 0);
        nearest = QuadricHit{
            t, outward.normalized(), {turn(p.x, p.z), float(0.5 - p.y / (2 * cone.half_height))}};
    }
}

void intersect_disc(double y, double radius, double normal_y, const V3d& o, const V3d& d,
                    double t_near, double t_far, std::optional<QuadricHit>& nearest) {
    if (d.y == 0 || radius <= 0) return;
    const double t = (y - o.y) / d.y;
    if (!(t > t_near && t < t_far) || (nearest && nearest->t <= t)) return;
    const double x = o.x + d.x * t;
    const double z = o.z + d.z * t;
    const double ring = std::hypot(x, z);
    if (ring > radius) return;
    nearest = QuadricHit{t, V3d(0, normal_y, 0), {turn(x, z), float(ring / radius)}};
}

} // namespace

std::optional<QuadricHit> intersect_shape(const ImplicitShape& shape, const V3d& origin,
                                          const V3d& direction, double t_near, double t_far) {
    if (shape.kind == ImplicitShape::Kind::sphere)
        return intersect_sphere(shape, origin, direction, t_near, t_far);
    const ConeProfile cone = profile_of(shape);
    // As for the sphere, start at the point of the line nearest to the centre.
    const double t_closest = -origin.dot(direction) / direction.dot(direction);
    const V3d closest = origin + direction * t_closest;
    const double from = t_near - t_closest, to = t_far - t_closest;
    std::optional<QuadricHit> nearest;
    intersect_side(cone, closest, direction, from, to, nearest);
    intersect_disc(-cone.half_height, cone.bottom, -1, closest, direction, from, to, nearest);
    intersect_disc(cone.half_height, double(shape.radius_top), 1, closest, direction, from, to,
                   nearest);
    if (nearest) nearest->t += t_closest;
    return nearest;
}

double shape_area(const ImplicitShape& shape) {
    if (shape.kind == ImplicitShape::Kind::sphere)
        return 4 * kPi * double(shape.radius) * double(shape.radius);
    const ConeAreas areas = areas_of(shape);
    return areas.side + areas.bottom + areas.top;
}

BodyPoint uniform_point(const ImplicitShape& shape, double u, double v) {
    const double phi = 2 * kPi * v;
    // As turn() has it.
    const V3d around(-std::cos(phi), 0, -std::sin(phi));
    if (shape.kind == ImplicitShape::Kind::sphere) {
        const double y = 1 - 2 * u, ring = std::sqrt(std::max(0.0, (1 - y) * (1 + y)));
        const V3d normal = around * ring + V3d(0, y, 0);
        return {normal * double(shape.radius), normal, {float(v), float(std::acos(y) / kPi)}};
    }
    const ConeProfile cone = profile_of(shape);
    const ConeAreas areas = areas_of(shape);
    double left = u * (areas.side + areas.bottom + areas.top);
    if (left < areas.side) {
        // Height h in [0, 1]: rings of radius b + (t - b) h, whose sum up to h is the area below.
        const double b = cone.bottom, t = double(shape.radius_top);
        const double sum = left / areas.side * (b + t) / 2;
        const double root = std::sqrt(std::max(0.0, b * b + 2 * (t - b) * sum));
        const double h = std::min(1.0, 2 * sum / (b + root));
        const V3d outward = (around - V3d(0, cone.slope, 0)).normalized();
        const double y = (2 * h - 1) * cone.half_height;
        return {around * cone.radius(y) + V3d(0, y, 0), outward, {float(v), float(1 - h)}};
    }
    left -= areas.side;
    const bool is_top = left >= areas.bottom;
    const double area = is_top ? areas.top : areas.bottom;
    const double share = std::min(1.0, (is_top ? left - areas.bottom : left) / area);
    const double ring = std::sqrt(share), side = is_top ? 1 : -1;
    const double radius = is_top ? double(shape.radius_top) : cone.bottom;
    return {around * (ring * radius) + V3d(0, side * cone.half_height, 0),
            V3d(0, side, 0),
            {float(v), float(ring)}};
}

V3d off_cone_rim(const ImplicitShape& shape, const V3d& p, double margin) {
    const ConeProfile cone = profile_of(shape);
    const double side = p.y < 0 ? -1 : 1;
    const double ring = std::hypot(p.x, p.z);
    const double rim = cone.radius(side * cone.half_height);
    const double below_end = cone.half_height - std::abs(p.y);
    if (below_end >= margin || rim - ring >= margin) return p;
    // On the end disc go inwards, on the side towards the middle.
    if (std::abs(below_end) < std::abs(cone.radius(p.y) - ring)) {
        const double shrink = ring > 0 ? std::max(0.0, rim - margin) / ring : 1;
        return {p.x * shrink, p.y, p.z * shrink};
    }
    const double y = side * std::max(0.0, cone.half_height - margin);
    const double shrink = ring > 0 ? std::max(0.0, cone.radius(y)) / ring : 1;
    return {p.x * shrink, y, p.z * shrink};
}

V3d half_extent(const ImplicitShape& shape) {
    if (shape.kind == ImplicitShape::Kind::sphere) return V3d(double(shape.radius));
    const double r = double(std::max(shape.radius_bottom, shape.radius_top));
    return {r, double(shape.height) / 2, r};
}

} // namespace ql
