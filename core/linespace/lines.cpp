#include "linespace/lines.h"

#include "sampling/warp.h"

#include <numbers>

namespace ql {

namespace {

// Powers of the root of x^5 = x + 1, in units of 2^-32.
constexpr RandomWords kStep = {3679390609, 3152041523, 2700274806, 2313257605};

constexpr int kSetBits = 4;

V3f point_on(const PatchRectangle& r, float s, float t) {
    V3f p;
    p[r.axis] = r.plane;
    p[r.axis_u] = r.u + s * (r.high[r.axis_u] - r.u);
    p[r.axis_v] = r.v + t * (r.high[r.axis_v] - r.v);
    return p;
}

// The points at these coordinates of a patch, by axis.
void set_points(const PatchRectangle& r, const std::array<float, kLinesPerBlock>& s,
                const std::array<float, kLinesPerBlock>& t,
                std::array<float, kLinesPerBlock>* const points[3]) {
    const float width = r.high[r.axis_u] - r.u, height = r.high[r.axis_v] - r.v;
    points[r.axis]->fill(r.plane);
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
        (*points[r.axis_u])[i] = r.u + s[i] * width;
        (*points[r.axis_v])[i] = r.v + t[i] * height;
    }
}

void set_line(LineBlock& block, size_t i, const V3f& origin, const V3f& direction) {
    block.ox[i] = origin.x;
    block.oy[i] = origin.y;
    block.oz[i] = origin.z;
    block.dx[i] = direction.x;
    block.dy[i] = direction.y;
    block.dz[i] = direction.z;
    block.weight[i] = 1;
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
    : m_shift(philox4x32({voxel, number, 0, 0}, {0x6c696e65, 0})) {}

void LinePoints::fill(int first, Block& block) const {
    for (size_t k = 0; k < 4; ++k)
        for (uint32_t i = 0; i < kLinesPerBlock; ++i)
            block[k][i] = unit_float(m_shift[k] + kStep[k] * (uint32_t(first) + i + 1));
}

ShaftLines::ShaftLines(const ShaftEnds& ends, int patches, const V3d& cell, uint32_t voxel,
                       uint32_t number)
    : m_points(voxel, number), m_entry(rectangle_of(ends.entry_face, ends.entry_patch, patches)),
      m_exit(rectangle_of(ends.exit_face, ends.exit_patch, patches)),
      m_cell(cell / std::max({cell.x, cell.y, cell.z})) {
    for (int axis = 0; axis < 3; ++axis) {
        m_low[axis] = std::min(m_entry.low[axis], m_exit.low[axis]);
        m_high[axis] = std::max(m_entry.high[axis], m_exit.high[axis]);
    }
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
    // Choose points on both patches, squared towards an edge that both share: there the measure has
    // its peak.
    LinePoints::Block s;
    m_points.fill(first, s);
    block.weight.fill(1);
    for (size_t k = 0; k < 4; ++k) {
        if (m_edge[k] == 0) continue;
        const float base = m_edge[k] > 0 ? 1 : 0, sign = m_edge[k] > 0 ? -1 : 1;
        for (size_t i = 0; i < kLinesPerBlock; ++i) {
            block.weight[i] *= 2 * s[k][i];
            s[k][i] = base + sign * (s[k][i] * s[k][i]);
        }
    }
    using Numbers = std::array<float, kLinesPerBlock>;
    Numbers* const o[3] = {&block.ox, &block.oy, &block.oz};
    Numbers* const d[3] = {&block.dx, &block.dy, &block.dz};
    set_points(m_entry, s[0], s[1], o);
    set_points(m_exit, s[2], s[3], d);
    for (size_t axis = 0; axis < 3; ++axis)
        for (size_t i = 0; i < kLinesPerBlock; ++i)
            (*d[axis])[i] -= (*o[axis])[i];

    // Weigh them: cos_a cos_b / r^2. The quotients one by one: r^4 would leave the range of float.
    const Numbers &across_entry = *d[m_entry.axis], &across_exit = *d[m_exit.axis];
    const float entry_side = m_cell[m_entry.axis], exit_side = m_cell[m_exit.axis];
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
        const float x = block.dx[i] * m_cell.x, y = block.dy[i] * m_cell.y,
                    z = block.dz[i] * m_cell.z;
        const float r2 = x * x + y * y + z * z;
        const float weight = block.weight[i] * (std::abs(across_entry[i] * entry_side) / r2) *
                             (std::abs(across_exit[i] * exit_side) / r2);
        block.weight[i] = r2 > 0 ? weight : 0;
    }
}

VoxelLines::VoxelLines(const V3d& cell, int lines_per_set, const Workers& workers)
    : m_cell(cell), m_blocks_per_set(size_t(lines_per_set / kLinesPerBlock)),
      m_blocks(m_blocks_per_set << kSetBits) {
    double sum = 0;
    for (int face = 0; face < 6; ++face) {
        const int axis = face / 2;
        sum += cell[detail::kAxisU[axis]] * cell[detail::kAxisV[axis]];
        m_areas[size_t(face)] = sum;
    }
    workers.for_each(size_t{1} << kSetBits, [&](size_t set) {
        const LinePoints source(uint32_t(set), ~0u);
        for (size_t n = 0; n < m_blocks_per_set; ++n)
            fill(source, int(n) * kLinesPerBlock, m_blocks[set * m_blocks_per_set + n]);
    });
}

std::span<const VoxelLines::Block> VoxelLines::of_voxel(uint32_t voxel) const {
    const size_t set = (voxel * 0x9e3779b9u) >> (32 - kSetBits);
    return std::span(m_blocks).subspan(set * m_blocks_per_set, m_blocks_per_set);
}

double VoxelLines::measure() const {
    return std::numbers::pi * m_areas.back();
}

void VoxelLines::fill(const LinePoints& source, int first, Block& block) const {
    LinePoints::Block points;
    source.fill(first, points);
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
        const std::array<float, 4> s = {points[0][i], points[1][i], points[2][i], points[3][i]};
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
        set_line(block.lines, i, origin, V3f(way * end));
        block.shafts[i] = directed_shaft({face, 0, exit_face, 0}, 1);
    }
}

} // namespace ql
