#include "linespace/lines.h"

#include "sampling/random.h"
#include "sampling/warp.h"

#include <numbers>

namespace ql {

namespace {

// Powers of the root of x^5 = x + 1.
constexpr double kStep[4] = {0.85667488385450287, 0.73389185662604126, 0.62870672103975006,
                             0.53859725722344105};

V3f point_on(const PatchRectangle& r, float s, float t) {
    V3f p;
    p[r.axis] = r.plane;
    p[r.axis_u] = r.u + s * (r.high[r.axis_u] - r.u);
    p[r.axis_v] = r.v + t * (r.high[r.axis_v] - r.v);
    return p;
}

void set_line(LineBlock& block, size_t i, const V3f& origin, const V3f& direction, float weight) {
    block.ox[i] = origin.x;
    block.oy[i] = origin.y;
    block.oz[i] = origin.z;
    block.dx[i] = direction.x;
    block.dy[i] = direction.y;
    block.dz[i] = direction.z;
    block.weight[i] = weight;
}

} // namespace

PatchRectangle rectangle_of(int face, int patch, int patches) {
    PatchRectangle r;
    r.axis = face / 2;
    r.axis_u = detail::kAxisU[r.axis];
    r.axis_v = detail::kAxisV[r.axis];
    const float size = 1.0f / float(patches);
    r.plane = float(face % 2);
    r.u = float(patch % patches) * size;
    r.v = float(patch / patches) * size;
    r.low[r.axis] = r.high[r.axis] = r.plane;
    r.low[r.axis_u] = r.u;
    r.low[r.axis_v] = r.v;
    r.high[r.axis_u] = r.u + size;
    r.high[r.axis_v] = r.v + size;
    return r;
}

LinePoints::LinePoints(uint32_t voxel, uint32_t number)
    : m_shift(unit_floats(philox4x32({voxel, number, 0, 0}, {0x6c696e65, 0}))) {}

std::array<float, 4> LinePoints::operator()(int i) const {
    std::array<float, 4> point;
    for (size_t k = 0; k < 4; ++k) {
        const double x = double(m_shift[k]) + kStep[k] * double(i + 1);
        point[k] = std::min(float(x - std::floor(x)), 0x1.fffffep-1f);
    }
    return point;
}

ShaftLines::ShaftLines(const ShaftEnds& ends, int patches, const V3d& cell, uint32_t voxel,
                       uint32_t number)
    : m_points(voxel, number), m_entry(rectangle_of(ends.entry_face, ends.entry_patch, patches)),
      m_exit(rectangle_of(ends.exit_face, ends.exit_patch, patches)), m_cell(cell) {
    for (int axis = 0; axis < 3; ++axis) {
        m_low[axis] = std::min(m_entry.low[axis], m_exit.low[axis]);
        m_high[axis] = std::max(m_entry.high[axis], m_exit.high[axis]);
    }
    m_area = m_cell[m_entry.axis_u] * m_cell[m_entry.axis_v];
    find_shared_edge(ends, patches);
}

void ShaftLines::find_shared_edge(const ShaftEnds& ends, int patches) {
    if (m_entry.axis == m_exit.axis) return;
    const float half = 0.5f / float(patches);
    const auto side = [&](const PatchRectangle& r, int axis, int other_face) {
        const bool high_face = other_face % 2 == 1;
        const bool touches = high_face ? r.high[axis] > 1 - half : r.low[axis] < half;
        return !touches ? 0 : high_face ? 1 : -1;
    };
    const int a = side(m_entry, m_exit.axis, ends.exit_face);
    const int b = side(m_exit, m_entry.axis, ends.entry_face);
    if (a == 0 || b == 0) return;
    m_edge[m_entry.axis_u == m_exit.axis ? 0 : 1] = a;
    m_edge[m_exit.axis_u == m_entry.axis ? 2 : 3] = b;
}

void ShaftLines::fill(int first, LineBlock& block) const {
    for (int i = 0; i < kLinesPerBlock; ++i) {
        std::array<float, 4> s = m_points(first + i);
        float weight = 1;
        for (size_t k = 0; k < 4; ++k) {
            // Squared towards an edge that both patches share, where the measure peaks.
            if (m_edge[k] == 0) continue;
            weight *= 2 * s[k];
            s[k] = m_edge[k] > 0 ? 1 - s[k] * s[k] : s[k] * s[k];
        }
        const V3f a = point_on(m_entry, s[0], s[1]), b = point_on(m_exit, s[2], s[3]);
        const V3f d = b - a;
        const V3d way(double(d.x) * m_cell.x, double(d.y) * m_cell.y, double(d.z) * m_cell.z);
        const double r2 = way.length2();
        weight = r2 > 0 ? float(double(weight) * std::abs(way[m_entry.axis] * way[m_exit.axis]) /
                                (r2 * r2) * m_area)
                        : 0;
        set_line(block, size_t(i), a, d, weight);
    }
}

VoxelLines::VoxelLines(const V3d& cell, uint32_t voxel) : m_points(voxel, ~0u), m_cell(cell) {
    double sum = 0;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        sum += cell[detail::kAxisU[axis]] * cell[detail::kAxisV[axis]];
        m_areas[size_t(face)] = sum;
    }
}

double VoxelLines::measure() const {
    return std::numbers::pi * m_areas.back();
}

void VoxelLines::fill(int first, LineBlock& block,
                      std::array<uint32_t, kLinesPerBlock>& shafts) const {
    for (int i = 0; i < kLinesPerBlock; ++i) {
        const std::array<float, 4> s = m_points(first + i);
        // A point on one of the faces, by area.
        const double at = double(s[0]) * m_areas.back();
        int face = 0;
        while (face < 5 && at >= m_areas[size_t(face)])
            ++face;
        const double below = face == 0 ? 0 : m_areas[size_t(face) - 1];
        const auto along = float((at - below) / (m_areas[size_t(face)] - below));
        const V3f origin = point_on(rectangle_of(face, 0, 1), along, s[1]);

        // A direction by its cosine, up to the face where it leaves the voxel.
        const V3f local = square_to_cosine_hemisphere({s[2], s[3]});
        const int axis = face / 2;
        V3d way;
        way[axis] = std::max(double(local.z), 1e-6) * (face % 2 == 0 ? 1 : -1);
        way[detail::kAxisU[axis]] = double(local.x);
        way[detail::kAxisV[axis]] = double(local.y);
        double end = std::numeric_limits<double>::infinity();
        int exit_face = -1;
        for (int k = 0; k < 3; ++k) {
            way[k] /= m_cell[k];
            if (way[k] == 0) continue;
            const double t = ((way[k] > 0 ? 1 : 0) - double(origin[k])) / way[k];
            if (t >= end) continue;
            end = t;
            exit_face = 2 * k + (way[k] > 0 ? 1 : 0);
        }
        set_line(block, size_t(i), origin, V3f(way * end), 1);
        shafts[size_t(i)] = directed_shaft({face, 0, exit_face, 0}, 1);
    }
}

} // namespace ql
