#include "linespace/open_sides.h"

#include "geometry/surface_point.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <algorithm>
#include <array>

namespace ql {

namespace {

constexpr uint64_t kWalkKey = 0x6f70656e73696465;
constexpr size_t kWalks = 1 << 15, kWalksPerTask = 1 << 11;
constexpr uint32_t kSteps = 8;
// Fewer meetings than these say nothing.
constexpr uint64_t kEnoughMeetings = 200;
constexpr uint64_t kClosedShare = 100;

bool is_front(const SurfacePoint& point, const V3f& direction) {
    return point.ng.dot(direction) < 0;
}

// Counts how often a walk meets each side.
void walk(const EmbreeScene& rays, const LightEmission& emission, uint64_t number,
          std::vector<uint64_t>& meetings) {
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
        ++meetings[2 * size_t(point.surface) + (front ? 0 : 1)];
        const V3f normal = front ? point.ng : -point.ng;
        const RandomFloats next = random.block(2 + step);
        const V3f direction = frame_from_normal(normal).world_from_local(
            square_to_cosine_hemisphere({next[0], next[1]}));
        ray = {offset_origin(point.position, normal, point.offset, direction), 0, direction,
               kInfinity};
    }
}

} // namespace

OpenSides::OpenSides(const EmbreeScene& rays, const LightEmission& emission, const Workers& workers)
    : m_rays(rays), m_is_open(2 * rays.world().surfaces.size(), 1) {
    if (emission.empty()) return;
    constexpr size_t kTasks = kWalks / kWalksPerTask;
    std::array<std::vector<uint64_t>, kTasks> counts;
    workers.for_each(kTasks, [&](size_t task) {
        counts[task].resize(m_is_open.size());
        for (size_t i = 0; i < kWalksPerTask; ++i)
            walk(rays, emission, task * kWalksPerTask + i, counts[task]);
    });
    for (size_t surface = 0; 2 * surface < m_is_open.size(); ++surface) {
        uint64_t front = 0, back = 0;
        for (const auto& count : counts) {
            front += count[2 * surface];
            back += count[2 * surface + 1];
        }
        if (front + back < kEnoughMeetings) continue;
        m_is_open[2 * surface] = front * kClosedShare >= front + back;
        m_is_open[2 * surface + 1] = back * kClosedShare >= front + back;
    }
    m_all_open = closed_count() == 0;
}

bool OpenSides::leads_out(const V3d& point, const V3d& direction) const {
    if (m_all_open) return true;
    const Ray ray{V3f(point), 0, V3f(direction), kInfinity};
    Hit hit;
    // Where alpha decides, the surface is taken for solid or not by the same key every time.
    if (!m_rays.intersect(ray, 0x9e3779b9, hit)) return true;
    const SurfacePoint at = geometric_point(m_rays.world(), ray, hit);
    return is_open(at.surface, is_front(at, ray.direction));
}

size_t OpenSides::closed_count() const {
    return size_t(std::count(m_is_open.begin(), m_is_open.end(), 0));
}

} // namespace ql
