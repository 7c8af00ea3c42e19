#include "linespace/line_hits.h"

#include "geometry/quadric.h"
#include "linespace/vertex.h"
#include "sampling/r2.h"

#include <algorithm>

namespace ql {

LineHits::LineHits(const World& world, const OpenSides& sides, const AlphaTest* alpha_test,
                   const Blur& blur, const VoxelGrid& grid, uint32_t voxel,
                   std::span<const Primitive> primitives, int normal_classes)
    : m_world(world), m_sides(sides), m_alpha_test(alpha_test), m_blur(blur), m_voxel(voxel),
      m_lower(grid.corner(voxel)), m_cell(grid.cell), m_classes(normal_classes) {
    for (const Primitive& primitive : primitives) {
        const Surface& surface = world.surfaces[primitive.surface];
        const Material& material = world.scene->materials[size_t(surface.material)];
        if (surface.kind != Surface::Kind::triangles) {
            m_shapes.push_back({&surface, primitive, takes_light(material),
                                material.alpha_mode != AlphaMode::opaque});
            continue;
        }
        m_triangles.push_back(local_triangle(primitive, normal_classes));
        m_has_alpha |= m_triangles.back().has_alpha;
    }
}

auto LineHits::local_triangle(const Primitive& primitive, int classes) const -> LocalTriangle {
    const Surface& surface = m_world.surfaces[primitive.surface];
    const Material& material = m_world.scene->materials[size_t(surface.material)];
    const auto corners = triangle_corners(m_world, primitive.surface, primitive.triangle);
    LocalTriangle triangle;
    std::array<V3d, 3> local;
    for (size_t i = 0; i < 3; ++i) {
        const V3d p = V3d(corners[i]) - m_lower;
        local[i] = {p.x / m_cell.x, p.y / m_cell.y, p.z / m_cell.z};
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
    const V3d normal = (V3d(corners[1]) - V3d(corners[0])).cross(V3d(corners[2]) - V3d(corners[0]));
    triangle.normal = triangle.edge1.cross(triangle.edge2);
    // Corners of mirrored instances run the other way around.
    const bool ccw_is_front = surface.winding > 0;
    if (takes_light(material)) {
        if (m_sides.is_open(primitive.surface, ccw_is_front))
            triangle.front_class = normal_class(normal, classes);
        if (m_sides.is_open(primitive.surface, !ccw_is_front))
            triangle.back_class = normal_class(-normal, classes);
    }
    triangle.primitive = primitive;
    triangle.offset = triangle_offset(surface, corners);
    triangle.has_alpha = material.alpha_mode != AlphaMode::opaque;
    return triangle;
}

void LineHits::choose(const V3f& low, const V3f& high) {
    m_chosen.clear();
    for (const LocalTriangle& t : m_triangles)
        if (t.low.x <= high.x && t.high.x >= low.x && t.low.y <= high.y && t.high.y >= low.y &&
            t.low.z <= high.z && t.high.z >= low.z)
            m_chosen.push_back(&t);
}

// Moeller & Trumbore, "Fast, minimum storage ray/triangle intersection", JGT 2 (1997).
void LineHits::intersect(const LocalTriangle& triangle, const LineBlock& lines, Intersections& at) {
    const V3f p0 = triangle.corner, e1 = triangle.edge1, e2 = triangle.edge2;
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
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
        const float t = (e2.x * qx + e2.y * qy + e2.z * qz) * inverse;
        const bool hit = (bu >= 0) & (bv >= 0) & (bu + bv <= 1) & (t >= 0) & (t <= 1);
        at.t[i] = hit ? t : 2;
        at.u[i] = bu;
        at.v[i] = bv;
    }
}

void LineHits::visit_first(const LineBlock& lines, const Sink& sink) const {
    if (m_has_alpha || !m_shapes.empty()) return visit_hits(lines, true, sink);
    std::array<float, kLinesPerBlock> nearest_t;
    std::array<int, kLinesPerBlock> nearest;
    nearest_t.fill(2);
    nearest.fill(-1);
    Intersections at;
    for (size_t n = 0; n < m_chosen.size(); ++n) {
        intersect(*m_chosen[n], lines, at);
        for (size_t i = 0; i < kLinesPerBlock; ++i) {
            const bool nearer = at.t[i] < nearest_t[i];
            nearest_t[i] = nearer ? at.t[i] : nearest_t[i];
            nearest[i] = nearer ? int(n) : nearest[i];
        }
    }
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
        if (nearest[i] < 0) continue;
        const LocalTriangle& triangle = *m_chosen[size_t(nearest[i])];
        const int found = triangle.class_towards({lines.dx[i], lines.dy[i], lines.dz[i]});
        if (found >= 0) sink(i, found, 1);
    }
}

void LineHits::visit_all(const LineBlock& lines, const Sink& sink) const {
    visit_hits(lines, false, sink);
}

void LineHits::visit_hits(const LineBlock& lines, bool first_only, const Sink& sink) const {
    const LineHitLists found = hits_of(lines);
    for (size_t i = 0; i < kLinesPerBlock; ++i) {
        double passed = 1;
        for (const LineHit& hit : found[i]) {
            const double share = (first_only ? passed : 1) * double(hit.alpha);
            if (hit.normal_class >= 0 && share > 0) sink(i, hit.normal_class, share);
            passed *= 1 - double(hit.alpha);
        }
    }
}

void LineHits::visit_moved(const LineBlock& lines, uint32_t first, uint32_t number,
                           const Sink& sink) const {
    const LineHitLists found = hits_of(lines);
    const RandomWords shift = philox4x32({m_voxel, number, 1, 0}, {0x6c696e65, 0});
    for (uint32_t i = 0; i < kLinesPerBlock; ++i) {
        const uint32_t n = first + i;
        const V2f u(unit_float(shift[0] + n * kR2StepX), unit_float(shift[1] + n * kR2StepY));
        for (const LineHit& hit : found[i]) {
            if (hit.normal_class < 0 || !(hit.alpha > 0)) continue;
            const V3d way = to_render(lines.dx[i], lines.dy[i], lines.dz[i]);
            const V3d point =
                m_lower + to_render(lines.ox[i], lines.oy[i], lines.oz[i]) + way * double(hit.t);
            const double length = way.length();
            const uint32_t key = shift[2] + n * 0x9e3779b9u;
            const V3f position(point), w(way / -length);
            const V3f moved = position + m_blur.shift(position, hit.normal, hit.offset, u, key);
            if (m_blur.is_lit_from(moved, hit.normal, hit.offset, w, double(hit.t) * length, key))
                sink(i, hit.normal_class, double(hit.alpha));
        }
    }
}

auto LineHits::hits_of(const LineBlock& lines) const -> LineHitLists {
    LineHitLists found;
    Intersections at;
    for (const LocalTriangle* triangle : m_chosen) {
        intersect(*triangle, lines, at);
        for (size_t i = 0; i < kLinesPerBlock; ++i)
            if (at.t[i] <= 1) {
                const V3f d(lines.dx[i], lines.dy[i], lines.dz[i]);
                found[i].push_back(
                    {at.t[i], alpha_of(triangle->primitive, triangle->has_alpha, at.u[i], at.v[i]),
                     triangle->class_towards(d), normal_towards(*triangle, V3d(d)),
                     triangle->offset});
            }
    }
    for (const LocalShape& shape : m_shapes)
        for (size_t i = 0; i < kLinesPerBlock; ++i)
            add_shape_hits(shape, lines, i, found[i]);
    for (std::vector<LineHit>& hits : found)
        std::sort(hits.begin(), hits.end(),
                  [](const LineHit& a, const LineHit& b) { return a.t < b.t; });
    return found;
}

// d: in the coordinates of the voxel, in which the normal is that of render space times the cell.
V3f LineHits::normal_towards(const LocalTriangle& triangle, const V3d& d) const {
    V3d n(triangle.normal);
    const bool faces = n.dot(d) < 0;
    for (int axis = 0; axis < 3; ++axis)
        n[axis] /= m_cell[axis];
    return V3f(n.normalized()) * (faces ? 1.0f : -1.0f);
}

// The share of rays that the surface stops there: bisects the decision of the alpha test.
float LineHits::alpha_of(const Primitive& primitive, bool has_alpha, float u, float v) const {
    if (!has_alpha || !m_alpha_test) return 1;
    float low = 0, high = 1;
    for (int i = 0; i < 8; ++i) {
        const float middle = (low + high) / 2;
        const bool solid =
            m_alpha_test->is_solid(m_world, primitive.surface, primitive.triangle, u, v, middle);
        (solid ? low : high) = middle;
    }
    return low == 0 ? 0 : high == 1 ? 1 : low;
}

V3d LineHits::to_render(float x, float y, float z) const {
    return {double(x) * m_cell.x, double(y) * m_cell.y, double(z) * m_cell.z};
}

bool LineHits::is_open(const LineBlock& lines, size_t line) const {
    return m_all_open ||
           m_sides.leads_out(m_lower + to_render(lines.ox[line], lines.oy[line], lines.oz[line]),
                             -to_render(lines.dx[line], lines.dy[line], lines.dz[line]));
}

void LineHits::add_shape_hits(const LocalShape& shape, const LineBlock& lines, size_t i,
                              std::vector<LineHit>& found) const {
    const V3d o = m_lower + to_render(lines.ox[i], lines.oy[i], lines.oz[i]);
    const V3d d = to_render(lines.dx[i], lines.dy[i], lines.dz[i]);
    double from = 0;
    while (const auto hit =
               intersect_shape(*shape.surface->implicit, shape.surface->body_from_render.point(o),
                               shape.surface->body_from_render.vector(d), from, 1)) {
        V3f normal = detail::transformed(shape.surface->render_from_normal, V3f(hit->normal));
        if (normal.dot(V3f(d)) > 0) normal = -normal;
        found.push_back({float(hit->t),
                         alpha_of(shape.primitive, shape.has_alpha, hit->uv.x, hit->uv.y),
                         shape.takes_light ? normal_class(normal, m_classes) : -1, normal,
                         shape.surface->offset});
        from = std::nextafter(hit->t, 2.0); // intersect_shape() rounds
    }
}

} // namespace ql
