#include "reference/closed_shapes.h"

#include "sampling/random.h"
#include "sampling/warp.h"

namespace ql::reference {

namespace {

ClosedShape mesh_shape(const std::string& name, const Mesh& mesh, const M44d& world_from_shape,
                       bool flat_walls) {
    SceneBuilder b;
    b.add_material(lambert(V3f(1)));
    b.scene.meshes.push_back(mesh);
    b.place_mesh(0, world_from_shape);
    return {name, b.scene, flat_walls};
}

ClosedShape quadric_shape(const std::string& name, const ImplicitShape& shape,
                          const M44d& world_from_shape) {
    SceneBuilder b;
    b.add_material(lambert(V3f(1)));
    b.place_shape(shape, world_from_shape);
    return {name, b.scene, false};
}

// A far triangle makes the shape a small part of its scene, away from the middle.
ClosedShape inside_large_scene(ClosedShape shape) {
    SceneBuilder b;
    b.scene = std::move(shape.scene);
    b.add_triangle({-900, -800, -1000}, {-900, -801, -1000}, {-901, -800, -1000}, 0);
    shape.scene = std::move(b.scene);
    shape.name += " in a large scene";
    return shape;
}

// A second use of its mesh makes an instance of it.
ClosedShape instanced(ClosedShape shape) {
    SceneBuilder b;
    b.scene = std::move(shape.scene);
    b.place_mesh(0, *b.scene.nodes[0].matrix * translated({40, 3, 7}));
    shape.scene = std::move(b.scene);
    shape.name += ", instanced";
    return shape;
}

struct Wall {
    uint32_t surface, primitive;
    V3f normal;
};

class Tracer {
  public:
    Tracer(const ClosedShape& shape, const PosedScene& posed, float offset_share)
        : m_shape(shape), m_posed(posed), m_offset_share(offset_share) {}

    LeakCounts path(CounterRandom random, int bounces) const {
        LeakCounts counts;
        const RandomFloats start = random.next_block();
        const V3d inner(double(start[0]) - 0.5, double(start[1]) - 0.5, double(start[2]) - 0.5);
        V3d world;
        m_posed.world().world_from_node[0].multVecMatrix(inner, world);
        const RandomFloats u = random.next_block();
        Ray ray{V3f(m_posed.world().space.from_world(world)), 0,
                square_to_uniform_sphere({u[0], u[1]}), kInfinity};
        const Wall* from = nullptr;
        Wall wall{};
        for (int bounce = 0; bounce < bounces; ++bounce) {
            ++counts.rays;
            Hit hit;
            if (!m_posed.rays().intersect(ray, 0, hit)) {
                ++counts.leaks;
                break;
            }
            const SurfacePoint point = geometric_point(m_posed.world(), ray, hit);
            if (from && is_self_hit(*from, point, ray, hit)) {
                ++counts.self_hits;
                break;
            }
            const bool belongs = m_posed.world().surfaces[hit.surface].node == 0;
            if (!belongs || !(point.ng.dot(ray.direction) > 0)) {
                ++counts.leaks;
                break;
            }
            wall = {point.surface, point.primitive, point.ng};
            from = &wall;
            const RandomFloats v = random.next_block();
            const V3f direction = frame_from_normal(-point.ng).world_from_local(
                square_to_cosine_hemisphere({v[0], v[1]}));
            if (!(direction.dot(point.ng) < 0)) break;
            ray = {
                offset_origin(point.position, point.ng, point.offset * m_offset_share, direction),
                0, direction, kInfinity};
        }
        return counts;
    }

  private:
    bool is_self_hit(const Wall& from, const SurfacePoint& to, const Ray& ray,
                     const Hit& hit) const {
        if (m_shape.flat_walls) return from.normal.dot(to.ng) > 0.999f;
        const bool triangles =
            m_posed.world().surfaces[to.surface].kind == Surface::Kind::triangles;
        if (triangles) return from.surface == to.surface && from.primitive == to.primitive;
        return hit.t * ray.direction.length() < 4 * to.offset && from.normal.dot(to.ng) > 0.999f;
    }

    const ClosedShape& m_shape;
    const PosedScene& m_posed;
    float m_offset_share;
};

} // namespace

void LeakCounts::add(const LeakCounts& other) {
    rays += other.rays;
    leaks += other.leaks;
    self_hits += other.self_hits;
}

std::vector<ClosedShape> closed_shapes() {
    const M44d turned = rotated(V3d(1, 2, 3).normalized(), 0.7);
    const M44d flat =
        scaled({1, 0.02, 0.3}) * rotated(V3d(3, -1, 2).normalized(), 1.9) * translated({3, 1, 2});
    ImplicitShape sphere;
    sphere.radius = 1;
    ImplicitShape cone;
    cone.kind = ImplicitShape::Kind::cone;
    cone.height = 2;
    cone.radius_bottom = 1.6f;
    cone.radius_top = 1;
    return {mesh_shape("cube", cube(1, 0), M44d(), true),
            mesh_shape("turned cube", cube(1, 0), turned, true),
            mesh_shape("flat turned box", cube(1, 0), flat, true),
            mesh_shape("cube of 6144 triangles", cube(32, 0), turned, true),
            inside_large_scene(mesh_shape("turned cube", cube(8, 0), turned, true)),
            instanced(mesh_shape("flat turned box", cube(8, 0), flat, true)),
            mesh_shape("ball of triangles", sphere_mesh(32, 0), flat, false),
            quadric_shape("sphere", sphere, M44d()),
            quadric_shape("flat turned sphere", sphere, flat),
            quadric_shape("turned cone", cone, turned)};
}

LeakCounts count_leaks(const ClosedShape& shape, uint64_t paths, int bounces, float offset_share,
                       uint64_t seed, const Workers& workers) {
    const RenderSpace space = render_space_of(shape.scene, workers);
    const PosedScene posed(shape.scene, space, 0, workers);
    const Tracer tracer(shape, posed, offset_share);
    constexpr uint64_t kChunk = 1024;
    std::vector<LeakCounts> chunks(size_t((paths + kChunk - 1) / kChunk));
    workers.for_each(chunks.size(), [&](size_t chunk) {
        for (uint64_t i = chunk * kChunk; i < std::min(paths, (chunk + 1) * kChunk); ++i)
            chunks[chunk].add(tracer.path(CounterRandom(seed, i), bounces));
    });
    LeakCounts counts;
    for (const LeakCounts& chunk : chunks)
        counts.add(chunk);
    return counts;
}

} // namespace ql::reference
