#include "geometry/world.h"

#include "base/error.h"
#include "geometry/quadric.h"
#include "geometry/surface_point.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

using Imath::Box3d;

// Sharing saves memory but costs every ray a transformation: only meshes of some size are shared.
constexpr size_t kMinSharedTriangles = 64;

std::vector<int> mesh_use_counts(const Scene& scene) {
    std::vector<int> uses(scene.meshes.size(), 0);
    for (const Node& node : scene.nodes)
        for (const int mesh : node.meshes)
            ++uses[size_t(mesh)];
    return uses;
}

// Corners of the shape's box, transformed: a box that holds the transformed shape.
Box3d shape_bounds(const ImplicitShape& shape, const Affine& transform) {
    const V3d h = half_extent(shape);
    Box3d box;
    for (int corner = 0; corner < 8; ++corner)
        box.extendBy(transform.point(
            {corner & 1 ? h.x : -h.x, corner & 2 ? h.y : -h.y, corner & 4 ? h.z : -h.z}));
    return box;
}

Box3d mesh_bounds(const Mesh& mesh, const Affine& transform) {
    Box3d box;
    for (const V3f& p : mesh.positions) // each is a corner of some triangle
        box.extendBy(transform.point(V3d(p)));
    return box;
}

float largest_coordinate(const Box3d& box) {
    double largest = 0;
    for (int axis = 0; axis < 3; ++axis)
        largest = std::max({largest, std::abs(box.min[axis]), std::abs(box.max[axis])});
    return float(largest);
}

std::shared_ptr<const Body> transformed_body(const Mesh& mesh, const Affine& transform) {
    auto body = std::make_shared<Body>();
    body->positions.reserve(mesh.positions.size() + 1);
    for (const V3f& p : mesh.positions)
        body->positions.emplace_back(transform.point(V3d(p)));
    body->positions.emplace_back(0, 0, 0);
    return body;
}

// A space of its own for a shared mesh: centred, longest side 1.
Affine body_from_mesh(const Mesh& mesh) {
    const Box3d box = mesh_bounds(mesh, Affine{});
    const V3d size = box.size();
    const double extent = std::max({size.x, size.y, size.z});
    const double s = extent > 0 ? 1 / extent : 1;
    Affine transform;
    transform.linear = Imath::M33d(s, 0, 0, 0, s, 0, 0, 0, s);
    transform.translation = box.center() * -s;
    return transform;
}

// Normals transform by the cofactor matrix: right for any scale, also where it has no inverse.
Imath::M33d cofactors(const Imath::M33d& m) {
    const V3d a(m[0][0], m[0][1], m[0][2]);
    const V3d b(m[1][0], m[1][1], m[1][2]);
    const V3d c(m[2][0], m[2][1], m[2][2]);
    const V3d r0 = b.cross(c), r1 = c.cross(a), r2 = a.cross(b);
    return {r0.x, r0.y, r0.z, r1.x, r1.y, r1.z, r2.x, r2.y, r2.z};
}

// Scaled so that its largest entry is 1: float then holds it for any unit of length.
Imath::M33f normalised(const Imath::M33d& m) {
    double largest = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            largest = std::max(largest, std::abs(m[i][j]));
    const double s = largest > 0 ? 1 / largest : 1;
    Imath::M33f result;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            result[i][j] = float(m[i][j] * s);
    return result;
}

Affine render_from_world(const RenderSpace& space) {
    Affine transform;
    transform.linear = Imath::M33d(space.scale, 0, 0, 0, space.scale, 0, 0, 0, space.scale);
    transform.translation = space.centre * -space.scale;
    return transform;
}

// The Frobenius norm: an upper bound of how much longer a vector can get.
float largest_stretch(const Affine& transform) {
    double sum = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            sum += transform.linear[i][j] * transform.linear[i][j];
    return float(std::sqrt(sum));
}

// Embree transforms rays by the inverse in float: no good for nodes that squash a mesh to a sheet.
bool has_float_inverse(const Affine& transform) {
    constexpr double kMinRatio = 1e-5; // of the volume to that of the cube of its longest side
    const double stretch = double(largest_stretch(transform));
    return std::abs(transform.linear.determinant()) > kMinRatio * stretch * stretch * stretch;
}

// A mesh that several nodes share, in a space of its own.
struct SharedBody {
    std::shared_ptr<const Body> body; // null: not shared
    Affine body_from_mesh;
};

// Meshes that appear more than once and are large enough for it to pay.
std::vector<SharedBody> shared_bodies(const Scene& scene, const Workers& workers) {
    const std::vector<int> uses = mesh_use_counts(scene);
    std::vector<SharedBody> shared(scene.meshes.size());
    workers.for_each(shared.size(), [&](size_t i) {
        const Mesh& mesh = scene.meshes[i];
        if (uses[i] < 2 || mesh.triangles.size() < kMinSharedTriangles) return;
        shared[i].body_from_mesh = body_from_mesh(mesh);
        shared[i].body = transformed_body(mesh, shared[i].body_from_mesh);
    });
    return shared;
}

Surface common_surface(int node, const Affine& render_from_node) {
    Surface surface;
    surface.node = node;
    const double determinant = render_from_node.linear.determinant();
    surface.winding = determinant < 0 ? -1.0f : 1.0f;
    Imath::M33d for_normals = cofactors(render_from_node.linear);
    if (determinant < 0) for_normals = for_normals * -1.0;
    surface.render_from_normal = normalised(for_normals);
    surface.render_from_tangent = normalised(render_from_node.linear);
    return surface;
}

bool is_singular(const Affine& transform) {
    const double d = transform.linear.determinant();
    return !std::isfinite(d) || d == 0;
}

struct PosedSurface {
    Surface surface;
    Box3d bounds; // empty: the transform squashes it to nothing
};

PosedSurface posed_mesh(const Scene& scene, const SharedBody& shared, int node, int mesh_index,
                        const Affine& render_from_node) {
    const Mesh& mesh = scene.meshes[size_t(mesh_index)];
    PosedSurface posed{common_surface(node, render_from_node), {}};
    Surface& surface = posed.surface;
    surface.mesh = mesh_index;
    surface.material = mesh.material;
    surface.instanced = shared.body && has_float_inverse(render_from_node);
    if (!surface.instanced) {
        surface.body = transformed_body(mesh, render_from_node);
        for (size_t i = 0; i < mesh.positions.size(); ++i)
            posed.bounds.extendBy(V3d(surface.body->positions[i]));
        return posed;
    }
    surface.body = shared.body;
    surface.render_from_body = compose(render_from_node, inverse(shared.body_from_mesh));
    surface.body_per_render = largest_stretch(inverse(surface.render_from_body));
    posed.bounds = mesh_bounds(mesh, render_from_node);
    // Embree transforms the ray: its error scales with the instance and with where it is.
    surface.offset = 2 * kOffsetFactor * std::max(largest_coordinate(posed.bounds), 1e-6f);
    return posed;
}

PosedSurface posed_shape(const Scene& scene, int node, int shape_index,
                         const Affine& render_from_node) {
    const ImplicitShape& shape = scene.shapes[size_t(shape_index)];
    PosedSurface posed{common_surface(node, render_from_node), {}};
    if (is_singular(render_from_node)) return posed;
    Surface& surface = posed.surface;
    surface.kind =
        shape.kind == ImplicitShape::Kind::sphere ? Surface::Kind::sphere : Surface::Kind::cone;
    surface.shape = shape_index;
    surface.implicit = &shape;
    surface.material = shape.material;
    surface.render_from_body = render_from_node;
    surface.body_from_render = inverse(render_from_node);
    surface.body_per_render = largest_stretch(surface.body_from_render);
    posed.bounds = shape_bounds(shape, render_from_node);
    surface.offset = kOffsetFactor * std::max(largest_coordinate(posed.bounds), 1e-6f);
    return posed;
}

// What moves away must stay where squares of areas are floats.
void check_reach(const World& world, double time_seconds) {
    if (world.bounds.isEmpty()) return;
    for (int axis = 0; axis < 3; ++axis)
        for (const double reach : {world.bounds.min[axis], world.bounds.max[axis]})
            if (!(std::abs(reach) <= kMaxReach))
                throw input_error("at {} s the scene reaches {:g} times its extent at 0 s, "
                                  "expected at most {:g}",
                                  time_seconds, std::abs(reach), kMaxReach);
}

} // namespace

V3d Affine::vector(const V3d& v) const {
    return {linear[0][0] * v.x + linear[0][1] * v.y + linear[0][2] * v.z,
            linear[1][0] * v.x + linear[1][1] * v.y + linear[1][2] * v.z,
            linear[2][0] * v.x + linear[2][1] * v.y + linear[2][2] * v.z};
}

void detail::move_off_rim(const Surface& surface, SurfacePoint& point) {
    const V3d p = surface.body_from_render.point(V3d(point.position));
    const double margin = double(point.offset * surface.body_per_render);
    const V3d moved = off_cone_rim(*surface.implicit, p, margin);
    if (moved != p) point.position = V3f(surface.render_from_body.point(moved));
}

Affine inverse(const Affine& transform) {
    Affine result;
    result.linear = transform.linear.inverse();
    result.translation = -result.vector(transform.translation);
    return result;
}

Affine affine_from(const M44d& m) {
    Affine result;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            result.linear[row][column] = m[column][row];
    result.translation = {m[3][0], m[3][1], m[3][2]};
    return result;
}

Affine compose(const Affine& second, const Affine& first) {
    Affine result;
    result.linear = second.linear * first.linear;
    result.translation = second.point(first.translation);
    return result;
}

RenderSpace render_space_of(const Scene& scene, const Workers& workers) {
    const std::vector<M44d> poses = world_from_nodes(scene, 0);
    std::vector<Box3d> boxes(scene.nodes.size());
    workers.for_each(scene.nodes.size(), [&](size_t i) {
        const Affine world_from_node = affine_from(poses[i]);
        for (const int mesh : scene.nodes[i].meshes)
            boxes[i].extendBy(mesh_bounds(scene.meshes[size_t(mesh)], world_from_node));
        for (const int shape : scene.nodes[i].shapes)
            boxes[i].extendBy(shape_bounds(scene.shapes[size_t(shape)], world_from_node));
    });
    Box3d bounds;
    for (const Box3d& box : boxes)
        if (!box.isEmpty()) bounds.extendBy(box);
    RenderSpace space;
    if (bounds.isEmpty()) return space;
    const V3d size = bounds.size();
    const double extent = std::max({size.x, size.y, size.z});
    if (extent == 0) return space;
    if (!(extent >= kMinExtent && extent <= kMaxExtent))
        throw input_error("the scene extends over {:g} m, expected {:g} to {:g} m", extent,
                          kMinExtent, kMaxExtent);
    space.centre = bounds.center();
    space.scale = 1 / extent;
    return space;
}

World pose_world(const Scene& scene, const RenderSpace& space, double time_seconds,
                 const Workers& workers) {
    World world;
    world.scene = &scene;
    world.space = space;
    world.world_from_node = world_from_nodes(scene, time_seconds);

    // Lay out the surfaces first, then transform them in parallel.
    struct Item {
        int node, mesh, shape;
    };
    std::vector<Item> items;
    for (size_t i = 0; i < scene.nodes.size(); ++i) {
        for (const int mesh : scene.nodes[i].meshes)
            items.push_back({int(i), mesh, -1});
        for (const int shape : scene.nodes[i].shapes)
            items.push_back({int(i), -1, shape});
    }
    const std::vector<SharedBody> shared = shared_bodies(scene, workers);
    const Affine to_render = render_from_world(space);
    std::vector<PosedSurface> posed(items.size());
    workers.for_each(items.size(), [&](size_t i) {
        const auto& [node, mesh, shape] = items[i];
        const Affine transform =
            compose(to_render, affine_from(world.world_from_node[size_t(node)]));
        posed[i] = mesh >= 0 ? posed_mesh(scene, shared[size_t(mesh)], node, mesh, transform)
                             : posed_shape(scene, node, shape, transform);
    });
    for (PosedSurface& item : posed) {
        if (item.bounds.isEmpty()) continue;
        world.bounds.extendBy(item.bounds);
        world.surfaces.push_back(std::move(item.surface));
    }
    check_reach(world, time_seconds);
    return world;
}

std::array<V3f, 3> triangle_corners(const World& world, uint32_t surface_index,
                                    uint32_t primitive) {
    const Surface& surface = world.surfaces[surface_index];
    const auto& triangle = world.scene->meshes[size_t(surface.mesh)].triangles[primitive];
    std::array<V3f, 3> corners;
    for (size_t i = 0; i < 3; ++i) {
        const V3f& p = surface.body->positions[triangle[i]];
        corners[i] = surface.instanced ? V3f(surface.render_from_body.point(V3d(p))) : p;
    }
    return corners;
}

float triangle_offset(const Surface& surface, const std::array<V3f, 3>& corners) {
    if (surface.instanced) return surface.offset;
    return kOffsetFactor *
           std::max({detail::largest_coordinate(corners[0]), detail::largest_coordinate(corners[1]),
                     detail::largest_coordinate(corners[2])});
}

} // namespace ql
