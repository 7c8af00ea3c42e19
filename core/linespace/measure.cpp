#include "linespace/measure.h"

#include "geometry/quadric.h"
#include "linespace/vertex.h"
#include "sampling/random.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ql {

namespace {

constexpr int kBlock = 32; // lines that are tested together

// A primitive in the coordinates of its voxel, whose corners are 0 and 1.
struct LocalTriangle {
    V3f corner, edge1, edge2;
    V3f low, high; // its box
    Primitive primitive;
    V3f normal; // edge1 x edge2
    int front_class = 0, back_class = 0;
    float alpha = 1; // below 1: ask the alpha test
    bool takes_light = false;

    // Class of the normal on the side that a line of direction d comes from.
    int class_towards(const V3f& d) const { return normal.dot(d) < 0 ? front_class : back_class; }
};

struct LocalShape {
    const Surface* surface;
    bool takes_light;
};

struct VoxelGeometry {
    std::vector<LocalTriangle> triangles;
    std::vector<LocalShape> shapes;
    bool has_alpha = false;
};

VoxelGeometry geometry_of(const World& world, const VoxelGrid& grid, uint32_t voxel,
                          std::span<const Primitive> primitives, int classes) {
    VoxelGeometry geometry;
    const V3d lower = grid.corner(voxel);
    for (const Primitive& primitive : primitives) {
        const Surface& surface = world.surfaces[primitive.surface];
        const Material& material = world.scene->materials[size_t(surface.material)];
        if (surface.kind != Surface::Kind::triangles) {
            geometry.shapes.push_back({&surface, takes_light(material)});
            continue;
        }
        const auto corners = triangle_corners(world, primitive.surface, primitive.triangle);
        LocalTriangle triangle;
        std::array<V3d, 3> local;
        for (size_t i = 0; i < 3; ++i) {
            const V3d p = V3d(corners[i]) - lower;
            local[i] = {p.x / grid.cell.x, p.y / grid.cell.y, p.z / grid.cell.z};
        }
        triangle.corner = V3f(local[0]);
        triangle.edge1 = V3f(local[1] - local[0]);
        triangle.edge2 = V3f(local[2] - local[0]);
        for (int axis = 0; axis < 3; ++axis) {
            triangle.low[axis] =
                float(std::min({local[0][axis], local[1][axis], local[2][axis]}) - 1e-5);
            triangle.high[axis] =
                float(std::max({local[0][axis], local[1][axis], local[2][axis]}) + 1e-5);
        }
        const V3d normal =
            (V3d(corners[1]) - V3d(corners[0])).cross(V3d(corners[2]) - V3d(corners[0]));
        triangle.normal = triangle.edge1.cross(triangle.edge2);
        triangle.front_class = normal_class(normal, classes);
        triangle.back_class = normal_class(-normal, classes);
        triangle.primitive = primitive;
        triangle.takes_light = takes_light(material);
        if (material.alpha_mode != AlphaMode::opaque) {
            triangle.alpha = 0.5f;
            geometry.has_alpha = true;
        }
        geometry.triangles.push_back(triangle);
    }
    return geometry;
}

// A patch as a rectangle in the coordinates of the voxel.
struct PatchRectangle {
    int axis, axis_u, axis_v;
    float plane;
    float u, v; // lower corner
    V3f low, high;
};

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

// Lines from one patch to the other, with their weight in the measure.
struct LineBlock {
    std::array<float, kBlock> ox, oy, oz, dx, dy, dz, weight;
    std::array<float, kBlock> t; // of the nearest hit; above 1: none
    std::array<int, kBlock> nearest;
};

class ShaftLines {
  public:
    ShaftLines(const ShaftEnds& ends, int patches, const V3d& cell, uint32_t voxel, uint32_t shaft)
        : m_entry(rectangle_of(ends.entry_face, ends.entry_patch, patches)),
          m_exit(rectangle_of(ends.exit_face, ends.exit_patch, patches)), m_cell(cell),
          m_size(1.0f / float(patches)) {
        const RandomWords words = philox4x32({voxel, shaft, 0, 0}, {0x6c696e65, 0});
        for (size_t i = 0; i < 4; ++i)
            m_shift[i] = unit_float(words[i]);
        find_shared_edge(ends);
    }

    const PatchRectangle& entry() const { return m_entry; }
    const PatchRectangle& exit() const { return m_exit; }

    void fill(int first, LineBlock& block) const {
        for (int i = 0; i < kBlock; ++i) {
            float s[4];
            float weight = 1;
            for (size_t k = 0; k < 4; ++k) {
                const double x = double(m_shift[k]) + kStep[k] * double(first + i + 1);
                s[k] = float(x - std::floor(x));
                // Squared towards an edge that both patches share, where the measure peaks.
                if (m_edge[k] == 0) continue;
                weight *= 2 * s[k];
                s[k] = m_edge[k] > 0 ? 1 - s[k] * s[k] : s[k] * s[k];
            }
            const V3f a = point(m_entry, s[0], s[1]), b = point(m_exit, s[2], s[3]);
            const V3f d = b - a;
            const auto n = size_t(i);
            block.ox[n] = a.x;
            block.oy[n] = a.y;
            block.oz[n] = a.z;
            block.dx[n] = d.x;
            block.dy[n] = d.y;
            block.dz[n] = d.z;
            const double wx = double(d.x) * m_cell.x, wy = double(d.y) * m_cell.y,
                         wz = double(d.z) * m_cell.z;
            const double way[3] = {wx, wy, wz};
            const double r2 = wx * wx + wy * wy + wz * wz;
            block.weight[n] =
                r2 > 0 ? float(double(weight) * std::abs(way[m_entry.axis] * way[m_exit.axis]) /
                               (r2 * r2) * m_area)
                       : 0;
        }
    }

  private:
    // Powers of the root of x^5 = x + 1: Roberts, "The unreasonable effectiveness of quasirandom
    // sequences" (2018), in four dimensions.
    static constexpr double kStep[4] = {0.85667488385450287, 0.73389185662604126,
                                        0.62870672103975006, 0.53859725722344105};

    static V3f point(const PatchRectangle& r, float s, float t) {
        V3f p;
        p[r.axis] = r.plane;
        p[r.axis_u] = r.u + s * (r.high[r.axis_u] - r.u);
        p[r.axis_v] = r.v + t * (r.high[r.axis_v] - r.v);
        return p;
    }

    // m_edge[k]: 0, or at which end (-1 low, +1 high) coordinate k meets the edge.
    void find_shared_edge(const ShaftEnds& ends) {
        m_area = m_cell[m_entry.axis_u] * m_cell[m_entry.axis_v]; // keeps the weights of order 1
        if (m_entry.axis == m_exit.axis) return;
        const auto side = [&](const PatchRectangle& r, int axis, int other_face) {
            const bool high_face = other_face % 2 == 1;
            const bool touches =
                high_face ? r.high[axis] > 1 - m_size / 2 : r.low[axis] < m_size / 2;
            return !touches ? 0 : high_face ? 1 : -1;
        };
        const int a = side(m_entry, m_exit.axis, ends.exit_face);
        const int b = side(m_exit, m_entry.axis, ends.entry_face);
        if (a == 0 || b == 0) return;
        m_edge[m_entry.axis_u == m_exit.axis ? 0 : 1] = a;
        m_edge[m_exit.axis_u == m_entry.axis ? 2 : 3] = b;
    }

    PatchRectangle m_entry, m_exit;
    V3d m_cell;
    float m_size;
    double m_area = 1;
    std::array<float, 4> m_shift{};
    std::array<int, 4> m_edge{};
};

// Moeller & Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 2 (1997): the
// parameter on each line, or 2 where the triangle is missed.
void intersect_block(const LocalTriangle& triangle, const LineBlock& lines,
                     std::array<float, kBlock>& t, std::array<float, kBlock>& u,
                     std::array<float, kBlock>& v) {
    const V3f p0 = triangle.corner, e1 = triangle.edge1, e2 = triangle.edge2;
    for (size_t i = 0; i < kBlock; ++i) {
        const float px = lines.dy[i] * e2.z - lines.dz[i] * e2.y;
        const float py = lines.dz[i] * e2.x - lines.dx[i] * e2.z;
        const float pz = lines.dx[i] * e2.y - lines.dy[i] * e2.x;
        const float det = e1.x * px + e1.y * py + e1.z * pz;
        const float sx = lines.ox[i] - p0.x, sy = lines.oy[i] - p0.y, sz = lines.oz[i] - p0.z;
        const float inverse = 1 / det;
        const float bu = (sx * px + sy * py + sz * pz) * inverse;
        const float qx = sy * e1.z - sz * e1.y;
        const float qy = sz * e1.x - sx * e1.z;
        const float qz = sx * e1.y - sy * e1.x;
        const float bv = (lines.dx[i] * qx + lines.dy[i] * qy + lines.dz[i] * qz) * inverse;
        const float at = (e2.x * qx + e2.y * qy + e2.z * qz) * inverse;
        const bool hit = (bu >= 0) & (bv >= 0) & (bu + bv <= 1) & (at >= 0) & (at <= 1);
        t[i] = hit ? at : 2;
        u[i] = bu;
        v[i] = bv;
    }
}

struct LineHit {
    float t;
    float alpha;
    int normal_class; // -1: takes no light
};

// How much a block of lines counts: for the gated layer the first surface, for caustics all.
class BlockCounter {
  public:
    BlockCounter(const World& world, const AlphaTest* alpha_test, const VoxelGrid& grid,
                 uint32_t voxel, const VoxelGeometry& geometry, int classes)
        : m_world(world), m_alpha_test(alpha_test), m_grid(grid), m_lower(grid.corner(voxel)),
          m_geometry(geometry), m_classes(classes) {}

    // Keeps the triangles whose boxes meet the box of the shaft; surfaces of that class count.
    void choose(const PatchRectangle& a, const PatchRectangle& b, int wanted_class) {
        m_wanted_class = wanted_class;
        m_chosen.clear();
        V3f low, high;
        for (int axis = 0; axis < 3; ++axis) {
            low[axis] = std::min(a.low[axis], b.low[axis]);
            high[axis] = std::max(a.high[axis], b.high[axis]);
        }
        for (const LocalTriangle& t : m_geometry.triangles)
            if (t.low.x <= high.x && t.high.x >= low.x && t.low.y <= high.y && t.high.y >= low.y &&
                t.low.z <= high.z && t.high.z >= low.z)
                m_chosen.push_back(&t);
    }

    // Adds the weights of what is met to hits and returns how many lines met something.
    double count(LineBlock& lines, bool caustic, double& hits) const {
        if (caustic || m_geometry.has_alpha || !m_geometry.shapes.empty())
            return count_all(lines, caustic, hits);
        lines.t.fill(2);
        lines.nearest.fill(-1);
        std::array<float, kBlock> t, u, v;
        for (size_t n = 0; n < m_chosen.size(); ++n) {
            intersect_block(*m_chosen[n], lines, t, u, v);
            for (size_t i = 0; i < kBlock; ++i) {
                const bool nearer = t[i] < lines.t[i];
                lines.t[i] = nearer ? t[i] : lines.t[i];
                lines.nearest[i] = nearer ? int(n) : lines.nearest[i];
            }
        }
        double met = 0;
        for (size_t i = 0; i < kBlock; ++i) {
            if (lines.nearest[i] < 0) continue;
            const LocalTriangle& triangle = *m_chosen[size_t(lines.nearest[i])];
            if (!triangle.takes_light ||
                triangle.class_towards({lines.dx[i], lines.dy[i], lines.dz[i]}) != m_wanted_class)
                continue;
            hits += double(lines.weight[i]);
            met += 1;
        }
        return met;
    }

  private:
    double count_all(const LineBlock& lines, bool caustic, double& hits) const {
        std::array<std::vector<LineHit>, kBlock> found;
        std::array<float, kBlock> t, u, v;
        for (const LocalTriangle* triangle : m_chosen) {
            intersect_block(*triangle, lines, t, u, v);
            for (size_t i = 0; i < kBlock; ++i)
                if (t[i] <= 1)
                    found[i].push_back(
                        {t[i], alpha_of(*triangle, u[i], v[i]),
                         triangle->takes_light
                             ? triangle->class_towards({lines.dx[i], lines.dy[i], lines.dz[i]})
                             : -1});
        }
        for (const LocalShape& shape : m_geometry.shapes)
            for (size_t i = 0; i < kBlock; ++i)
                add_shape_hits(shape, lines, i, found[i]);

        double met = 0;
        for (size_t i = 0; i < kBlock; ++i) {
            std::sort(found[i].begin(), found[i].end(),
                      [](const LineHit& a, const LineHit& b) { return a.t < b.t; });
            double share = 0, passed = 1;
            for (const LineHit& hit : found[i]) {
                if (hit.normal_class == m_wanted_class)
                    share += (caustic ? 1 : passed) * double(hit.alpha);
                passed *= 1 - double(hit.alpha);
            }
            hits += share * double(lines.weight[i]);
            met += share;
        }
        return met;
    }

    // The share of rays that the surface stops there: bisects the decision of the alpha test.
    float alpha_of(const LocalTriangle& triangle, float u, float v) const {
        if (triangle.alpha == 1 || !m_alpha_test) return 1;
        float low = 0, high = 1;
        for (int i = 0; i < 8; ++i) {
            const float middle = (low + high) / 2;
            const bool solid = m_alpha_test->is_solid(m_world, triangle.primitive.surface,
                                                      triangle.primitive.triangle, u, v, middle);
            (solid ? low : high) = middle;
        }
        return low == 0 ? 0 : high == 1 ? 1 : low;
    }

    void add_shape_hits(const LocalShape& shape, const LineBlock& lines, size_t i,
                        std::vector<LineHit>& found) const {
        const auto to_render = [&](float x, float y, float z) {
            return V3d(double(x) * m_grid.cell.x, double(y) * m_grid.cell.y,
                       double(z) * m_grid.cell.z);
        };
        const V3d o = m_lower + to_render(lines.ox[i], lines.oy[i], lines.oz[i]);
        const V3d d = to_render(lines.dx[i], lines.dy[i], lines.dz[i]);
        double from = 0;
        while (const auto hit = intersect_shape(
                   *shape.surface->implicit, shape.surface->body_from_render.point(o),
                   shape.surface->body_from_render.vector(d), from, 1)) {
            V3f normal = detail::transformed(shape.surface->render_from_normal, V3f(hit->normal));
            if (normal.dot(V3f(d)) > 0) normal = -normal;
            found.push_back(
                {float(hit->t), 1, shape.takes_light ? normal_class(normal, m_classes) : -1});
            from = hit->t + 1e-9;
        }
    }

    const World& m_world;
    const AlphaTest* m_alpha_test;
    const VoxelGrid& m_grid;
    V3d m_lower;
    const VoxelGeometry& m_geometry;
    int m_classes;
    int m_wanted_class = 0;
    std::vector<const LocalTriangle*> m_chosen;
};

// How many hits and lines are added so that the inverse of the share is unbiased: one would be
// right for random lines. Stratified lines vary less the more of them hit; the constant is that at
// which the mean of indirect light in a Cornell box agrees with path tracing.
double added_hits(double met) {
    constexpr double kStratified = 0.5;
    return (1 + kStratified * met) / (1 + met);
}

struct ShareEstimate {
    double share;
    int lines;
    bool found;
};

ShareEstimate share_of(const ShaftLines& shaft, const BlockCounter& counter, bool caustic,
                       const MeasureConfig& config) {
    LineBlock block;
    double hits = 0, weights = 0, met = 0;
    int wanted = kBlock;
    for (int lines = 0;;) {
        shaft.fill(lines, block);
        met += counter.count(block, caustic, hits);
        for (const float weight : block.weight)
            weights += double(weight);
        lines += kBlock;
        // The first set decides how many lines are enough.
        if (lines == kBlock && met < kBlock) {
            const double needed = config.enough_hits * kBlock / std::max(met, 0.5);
            wanted = int(std::ceil(needed / kBlock)) * kBlock;
            wanted = std::clamp(wanted, kBlock, config.max_lines);
        }
        if (lines < wanted) continue;
        const double added = added_hits(met) * weights / lines;
        return {(hits + added) / (weights + added), lines, met > 0};
    }
}

} // namespace

MeasureReport measure_shafts(const World& world, const AlphaTest* alpha_test,
                             const MeasureConfig& config, LightCache& cache, const Workers& workers,
                             Progress& progress) {
    const VoxelGrid grid = grid_of(cache.header, world.space);
    const int patches = cache.header.patches;
    const int classes = cache.header.normal_classes;
    const uint32_t directed = cache.header.directed();
    const EtendueTable etendue(cache.header.cell, patches);
    const size_t voxels = grid.size();
    std::vector<char> wanted(voxels);
    std::vector<uint32_t> filled;
    for (size_t v = 0; v < voxels; ++v) {
        wanted[v] = cache.first[v + 1] > cache.first[v];
        if (wanted[v]) filled.push_back(uint32_t(v));
    }
    const VoxelPrimitives primitives(world, grid, wanted, workers);

    cache.measures.resize(cache.size());
    std::vector<MeasureReport> reports(filled.size());
    progress.start("measuring shafts", filled.size());
    workers.for_each(filled.size(), [&](size_t n) {
        const uint32_t voxel = filled[n];
        const VoxelGeometry geometry =
            geometry_of(world, grid, voxel, primitives.of(voxel), classes);
        BlockCounter counter(world, alpha_test, grid, voxel, geometry, classes);
        for (uint64_t i = cache.first[voxel]; i < cache.first[voxel + 1]; ++i) {
            const bool caustic = cache.shafts[i] >= cache.header.caustics_from();
            const int wanted_class = int(cache.shafts[i] / directed) % classes;
            const ShaftEnds ends = shaft_ends(cache.shafts[i] % directed, patches);
            const ShaftLines shaft(ends, patches, grid.cell, voxel, cache.shafts[i]);
            counter.choose(shaft.entry(), shaft.exit(), wanted_class);
            const ShareEstimate estimate = share_of(shaft, counter, caustic, config);
            cache.measures[i] = float(etendue(ends) * estimate.share);
            reports[n].lines += uint64_t(estimate.lines);
            if (estimate.found) continue;
            ++reports[n].unmeasured_shafts;
            reports[n].unmeasured_weight +=
                std::ldexp(double(cache.sums[i][0]) + double(cache.sums[i][1]) +
                               double(cache.sums[i][2]),
                           -cache.header.sum_bits) /
                3;
        }
        progress.advance();
    });
    progress.finish();
    MeasureReport report;
    for (const MeasureReport& r : reports) {
        report.lines += r.lines;
        report.unmeasured_shafts += r.unmeasured_shafts;
        report.unmeasured_weight += r.unmeasured_weight;
    }
    return report;
}

} // namespace ql
