#include "linespace/open_sides.h"

#include "geometry/surface_point.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <algorithm>
#include <array>

namespace ql {

namespace {

constexpr uint64_t kWalkKey = 0x6f70656e73696465, kPointKey = 0x6f70656e73706f74;
constexpr size_t kWalks = 1 << 15, kWalksPerTask = 1 << 11;
constexpr uint32_t kSteps = 8;
// Fewer meetings than these say nothing.
constexpr uint64_t kEnoughMeetings = 200;
constexpr uint64_t kClosedShare = 100;
// Points of a side that are asked whether they are hidden: fewer, where there are many surfaces.
constexpr size_t kMostPoints = 128, kLeastPoints = 16, kAllPoints = 1 << 17;

bool is_front(const SurfacePoint& point, const V3f& direction) {
    return point.ng.dot(direction) < 0;
}

LitPoint lit_point(const SurfacePoint& point, bool front) {
    return {point.position, front ? point.ng : -point.ng, point.offset};
}

struct Meetings {
    std::vector<uint64_t> counts; // by side
    std::vector<LitPoint> points;
};

void walk(const EmbreeScene& rays, const LightEmission& emission, uint64_t number,
          Meetings& meetings) {
    const CounterRandom random(kWalkKey, number);
    const RandomWords pick = random.words(0);
    const RandomFloats u = random.block(1);
    const EmittedPhoton start =
        emission.sample(unit_double(pick[0], pick[1]), {u[0], u[1]}, {u[2], u[3]});
    Ray ray{start.origin, 0, start.direction, kInfinity};
    for (uint32_t step = 0; step < kSteps; ++step) {
        Hit hit;
        if (!rays.intersect(ray, pick[2] + step, hit)) return;
        const SurfacePoint point = geometric_point(rays.world(), ray, hit);
        const bool front = is_front(point, ray.direction);
        ++meetings.counts[2 * size_t(point.surface) + (front ? 0 : 1)];
        const LitPoint lit = lit_point(point, front);
        meetings.points.push_back(lit);
        const RandomFloats next = random.block(2 + step);
        const V3f direction =
            frame_from_normal(lit.normal)
                .world_from_local(square_to_cosine_hemisphere({next[0], next[1]}));
        ray = {offset_origin(lit.position, lit.normal, lit.offset, direction), 0, direction,
               kInfinity};
    }
}

// Uniform points of the triangles of a surface.
class TrianglePoints {
  public:
    TrianglePoints(const World& world, uint32_t surface) : m_world(world), m_surface(surface) {
        const size_t count =
            world.scene->meshes[size_t(world.surfaces[surface].mesh)].triangles.size();
        double area = 0;
        for (size_t t = 0; t < count; ++t)
            m_areas.push_back(area += cross_of(t).length());
    }

    // On the side of the corners' order, or on the other; u in [0, 1).
    LitPoint at(const RandomFloats& u, bool counter_clockwise) const {
        const auto found =
            std::upper_bound(m_areas.begin(), m_areas.end(), double(u[0]) * m_areas.back());
        const auto t = std::min(size_t(found - m_areas.begin()), m_areas.size() - 1);
        const auto corners = triangle_corners(m_world, m_surface, uint32_t(t));
        const float root = std::sqrt(u[1]);
        const V3f p =
            corners[0] * (1 - root) + corners[1] * (root * (1 - u[2])) + corners[2] * (root * u[2]);
        const V3d cross = cross_of(t);
        const double length = cross.length();
        if (!(length > 0)) return {p, V3f(0), 0};
        const float offset = triangle_offset(m_world.surfaces[m_surface], corners);
        return {p, V3f(cross / (counter_clockwise ? length : -length)), offset};
    }

  private:
    V3d cross_of(size_t t) const {
        const auto c = triangle_corners(m_world, m_surface, uint32_t(t));
        return (V3d(c[1]) - V3d(c[0])).cross(V3d(c[2]) - V3d(c[0]));
    }

    const World& m_world;
    uint32_t m_surface;
    std::vector<double> m_areas; // cumulative
};

} // namespace

OpenSides::OpenSides(const EmbreeScene& rays, const LightEmission& emission, const Workers& workers)
    : m_rays(rays), m_sides(2 * rays.world().surfaces.size(), Side::open),
      m_meetings(m_sides.size()) {
    if (emission.empty() || m_sides.empty()) return;
    walk_from(emission, workers);
    const size_t points = std::clamp(kAllPoints / m_sides.size(), kLeastPoints, kMostPoints);
    workers.for_each(m_sides.size(), [&](size_t side) {
        m_sides[side] = side_of(uint32_t(side / 2), side % 2 == 0, int(points));
    });
    m_all_open = closed_count() == 0 && mixed_count() == 0;
}

void OpenSides::walk_from(const LightEmission& emission, const Workers& workers) {
    constexpr size_t kTasks = kWalks / kWalksPerTask;
    std::array<Meetings, kTasks> tasks;
    workers.for_each(kTasks, [&](size_t task) {
        tasks[task].counts.resize(m_sides.size());
        for (size_t i = 0; i < kWalksPerTask; ++i)
            walk(m_rays, emission, task * kWalksPerTask + i, tasks[task]);
    });
    std::vector<LitPoint> points;
    for (const Meetings& task : tasks) {
        for (size_t side = 0; side < m_sides.size(); ++side)
            m_meetings[side] += task.counts[side];
        points.insert(points.end(), task.points.begin(), task.points.end());
    }
    m_lit.emplace(m_rays, std::move(points));
}

OpenSides::Side OpenSides::side_of(uint32_t surface, bool front, int points) const {
    const uint64_t own = m_meetings[2 * size_t(surface) + (front ? 0 : 1)];
    const uint64_t both = m_meetings[2 * size_t(surface)] + m_meetings[2 * size_t(surface) + 1];
    const bool is_known = both >= kEnoughMeetings;
    if (is_known && own * kClosedShare < both) return Side::closed;
    const Surface& body = m_rays.world().surfaces[surface];
    if (body.kind != Surface::Kind::triangles) return Side::open;

    // How much of it is hidden?
    const TrianglePoints source(m_rays.world(), surface);
    const CounterRandom random(kPointKey, 2 * uint64_t(surface) + (front ? 0 : 1));
    int hidden = 0;
    for (int i = 0; i < points; ++i) {
        const LitPoint point = source.at(random.block(uint32_t(i)), front == (body.winding > 0));
        hidden += m_lit->any_seen_from(point) ? 0 : 1;
    }
    if (hidden == points && own == 0) return Side::closed;
    return hidden == 0 ? Side::open : Side::mixed;
}

bool OpenSides::leads_out(const V3d& point, const V3d& direction) const {
    if (m_all_open) return true;
    const Ray ray{V3f(point), 0, V3f(direction), kInfinity};
    Hit hit;
    // Where alpha decides, the surface is taken for solid or not by the same key every time.
    if (!m_rays.intersect(ray, 0x9e3779b9, hit)) return true;
    const SurfacePoint at = geometric_point(m_rays.world(), ray, hit);
    const bool front = is_front(at, ray.direction);
    const Side side = m_sides[2 * size_t(at.surface) + (front ? 0 : 1)];
    if (side != Side::mixed) return side == Side::open;
    return m_lit->any_seen_from(lit_point(at, front));
}

size_t OpenSides::closed_count() const {
    return size_t(std::count(m_sides.begin(), m_sides.end(), Side::closed));
}

size_t OpenSides::mixed_count() const {
    return size_t(std::count(m_sides.begin(), m_sides.end(), Side::mixed));
}

} // namespace ql
