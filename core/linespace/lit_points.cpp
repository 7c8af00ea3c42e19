#include "linespace/lit_points.h"

#include "sampling/random.h"

#include <algorithm>
#include <bit>

namespace ql {

namespace {

constexpr int kCells = 32; // along each axis
// Points that are asked at most: candidates, and rays among them.
constexpr int kNearCandidates = 24, kNearRays = 8;
constexpr int kAroundCandidates = 16, kAroundRays = 8, kAroundCells = 2;
constexpr int kFarCandidates = 48, kFarRays = 16;

} // namespace

LitPoints::LitPoints(const EmbreeScene& rays, std::vector<LitPoint> points)
    : m_rays(rays), m_first(size_t(kCells) * kCells * kCells + 1) {
    if (points.empty()) return;
    V3f upper = m_lower = points[0].position;
    for (const LitPoint& point : points)
        for (int axis = 0; axis < 3; ++axis) {
            m_lower[axis] = std::min(m_lower[axis], point.position[axis]);
            upper[axis] = std::max(upper[axis], point.position[axis]);
        }
    const V3f size = upper - m_lower;
    const float side = std::max({size.x, size.y, size.z});
    m_cells_per_unit = side > 0 ? kCells / side : 0;

    // Sort by cell, in the order given.
    for (const LitPoint& point : points)
        ++m_first[cell_of(point.position) + 1];
    for (size_t c = 1; c < m_first.size(); ++c)
        m_first[c] += m_first[c - 1];
    std::vector<uint32_t> next(m_first.begin(), m_first.end() - 1);
    m_points.resize(points.size());
    for (const LitPoint& point : points)
        m_points[next[cell_of(point.position)]++] = point;
}

size_t LitPoints::cell_of(const V3f& position) const {
    size_t cell = 0;
    for (int axis = 2; axis >= 0; --axis) {
        const float at = (position[axis] - m_lower[axis]) * m_cells_per_unit;
        cell = cell * kCells + size_t(std::clamp(at, 0.0f, float(kCells - 1)));
    }
    return cell;
}

// Takes a ray from rays_left if the sides face each other.
bool LitPoints::sees(const LitPoint& a, const LitPoint& b, int& rays_left) const {
    const V3f way = b.position - a.position;
    if (!(way.dot(a.normal) > 0) || !(way.dot(b.normal) < 0)) return false;
    --rays_left;
    Ray ray;
    ray.origin = offset_origin(a.position, a.normal, a.offset, way);
    ray.direction = offset_origin(b.position, b.normal, b.offset, -way) - ray.origin;
    ray.t_far = 1;
    // Where alpha decides, a surface is taken for solid or not by the same key every time.
    return !m_rays.is_occluded(ray, 0x9e3779b9);
}

bool LitPoints::any_seen_from(const LitPoint& point) const {
    if (m_points.empty()) return false;
    const V3f& p = point.position;
    uint32_t block = 0;
    const auto random = [&] {
        return philox4x32({std::bit_cast<uint32_t>(p.x), std::bit_cast<uint32_t>(p.y),
                           std::bit_cast<uint32_t>(p.z), block++},
                          {0x6c697421, 0});
    };
    const auto pick = [](uint32_t word, size_t count) {
        return size_t(uint64_t(word) * count >> 32);
    };

    // In its own cell, then in those around it.
    const size_t home = cell_of(p);
    const size_t at_home = m_first[home + 1] - m_first[home];
    int left = kNearRays;
    if (at_home > 0) {
        const size_t start = pick(random()[0], at_home);
        for (size_t i = 0; i < std::min(at_home, size_t(kNearCandidates)) && left > 0; ++i)
            if (sees(point, m_points[m_first[home] + (start + i) % at_home], left)) return true;
    }
    left = kAroundRays;
    const float reach = kAroundCells / std::max(m_cells_per_unit, 1e-30f);
    for (int i = 0; i < kAroundCandidates && left > 0; ++i) {
        const RandomWords words = random();
        const RandomFloats u = unit_floats(words);
        const size_t cell = cell_of(p + V3f(2 * u[0] - 1, 2 * u[1] - 1, 2 * u[2] - 1) * reach);
        const size_t count = m_first[cell + 1] - m_first[cell];
        if (count > 0 && sees(point, m_points[m_first[cell] + pick(words[3], count)], left))
            return true;
    }
    // Anywhere.
    left = kFarRays;
    for (int i = 0; i < kFarCandidates && left > 0; ++i)
        if (sees(point, m_points[pick(random()[0], m_points.size())], left)) return true;
    return false;
}

} // namespace ql
