#include "reference/scene_builder.h"
#include "sampling/seeds.h"

#include <cmath>
#include <numbers>
#include <numeric>

namespace ql::reference {

Material lambert(const V3f& albedo) {
    Material m;
    m.model = MaterialModel::phong;
    m.base_color = albedo;
    return m;
}

Material mirror() {
    Material m = lambert(V3f(0));
    m.kd = 0;
    m.kr = 1;
    return m;
}

Material glass(float ior) {
    Material m = lambert(V3f(0));
    m.kd = 0;
    m.kt = 1;
    m.ior = ior;
    return m;
}

Material glossy(const V3f& diffuse, float specular, float exponent) {
    Material m = lambert(diffuse);
    m.ks = specular;
    m.exponent = exponent;
    return m;
}

Material metal(float roughness) {
    Material m;
    m.roughness = roughness;
    return m;
}

Material emitter(const V3f& radiance, const V3f& albedo) {
    Material m = lambert(albedo);
    m.emission = radiance;
    return m;
}

M44d translated(const V3d& by) {
    M44d m;
    m.setTranslation(by);
    return m;
}

M44d scaled(const V3d& by) {
    M44d m;
    m.setScale(by);
    return m;
}

M44d rotated(const V3d& axis, double radians) {
    M44d m;
    m.setAxisAngle(axis, radians);
    return m;
}

Light point_light(const V3d& intensity) {
    Light light;
    light.intensity = intensity;
    return light;
}

int SceneBuilder::add_material(const Material& material) {
    scene.materials.push_back(material);
    return int(scene.materials.size()) - 1;
}

int SceneBuilder::add_mesh(std::vector<V3f> positions,
                           std::vector<std::array<uint32_t, 3>> triangles, int material) {
    Mesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    mesh.material = material;
    scene.meshes.push_back(std::move(mesh));
    return int(scene.meshes.size()) - 1;
}

int SceneBuilder::place_mesh(int mesh, const M44d& world_from_node) {
    Node node;
    node.matrix = world_from_node;
    node.meshes = {mesh};
    scene.nodes.push_back(node);
    return int(scene.nodes.size()) - 1;
}

int SceneBuilder::place_shape(const ImplicitShape& shape, const M44d& world_from_node) {
    scene.shapes.push_back(shape);
    Node node;
    node.matrix = world_from_node;
    node.shapes = {int(scene.shapes.size()) - 1};
    scene.nodes.push_back(node);
    return int(scene.nodes.size()) - 1;
}

int SceneBuilder::place_light(const Light& light, const M44d& world_from_node) {
    scene.lights.push_back(light);
    Node node;
    node.matrix = world_from_node;
    node.light = int(scene.lights.size()) - 1;
    scene.nodes.push_back(node);
    return int(scene.nodes.size()) - 1;
}

int SceneBuilder::add_quad(const V3f& corner, const V3f& edge1, const V3f& edge2, int material) {
    return place_mesh(add_mesh({corner, corner + edge1, corner + edge1 + edge2, corner + edge2},
                               {std::array<uint32_t, 3>{0, 1, 2}, std::array<uint32_t, 3>{0, 2, 3}},
                               material));
}

int SceneBuilder::add_triangle(const V3f& a, const V3f& b, const V3f& c, int material) {
    return place_mesh(add_mesh({a, b, c}, {std::array<uint32_t, 3>{0, 1, 2}}, material));
}

void SceneBuilder::add_sphere(const V3d& centre, double radius, int material) {
    ImplicitShape shape;
    shape.radius = float(radius);
    shape.material = material;
    place_shape(shape, translated(centre));
}

Mesh cube(int cells, int material) {
    Mesh mesh;
    mesh.material = material;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {-1.0f, 1.0f}) {
            const auto base = uint32_t(mesh.positions.size());
            for (int j = 0; j <= cells; ++j)
                for (int i = 0; i <= cells; ++i) {
                    V3f p;
                    p[axis] = side;
                    p[(axis + 1) % 3] = 2 * float(i) / float(cells) - 1;
                    p[(axis + 2) % 3] = 2 * float(j) / float(cells) - 1;
                    mesh.positions.push_back(p);
                }
            const auto across = uint32_t(cells + 1);
            for (uint32_t j = 0; j + 1 < across; ++j)
                for (uint32_t i = 0; i + 1 < across; ++i) {
                    const uint32_t a = base + j * across + i, b = a + 1, c = b + across,
                                   d = a + across;
                    if (side > 0) {
                        mesh.triangles.push_back({a, b, c});
                        mesh.triangles.push_back({a, c, d});
                    } else {
                        mesh.triangles.push_back({a, c, b});
                        mesh.triangles.push_back({a, d, c});
                    }
                }
        }
    return mesh;
}

namespace {

// Rings of a surface of revolution about y, from the profile's points (radius, y), bottom to top.
Mesh revolved(const std::vector<V2f>& profile, int segments, int material) {
    Mesh mesh;
    mesh.material = material;
    for (const V2f& point : profile)
        for (int i = 0; i < segments; ++i) {
            const double angle = 2 * std::numbers::pi * i / segments;
            mesh.positions.emplace_back(float(double(point.x) * std::cos(angle)), point.y,
                                        float(-double(point.x) * std::sin(angle)));
        }
    const auto n = uint32_t(segments);
    for (uint32_t ring = 0; ring + 1 < profile.size(); ++ring)
        for (uint32_t i = 0; i < n; ++i) {
            const uint32_t a = ring * n + i, b = ring * n + (i + 1) % n, c = b + n, d = a + n;
            if (profile[ring].x > 0) mesh.triangles.push_back({a, b, c});
            if (profile[ring + 1].x > 0) mesh.triangles.push_back({a, c, d});
        }
    return mesh;
}

} // namespace

Mesh sphere_mesh(int rings, int material) {
    std::vector<V2f> profile;
    for (int i = 0; i <= rings; ++i) {
        const double angle = std::numbers::pi * i / rings;
        const bool pole = i == 0 || i == rings;
        profile.emplace_back(pole ? 0.0f : float(std::sin(angle)), float(-std::cos(angle)));
    }
    return revolved(profile, 2 * rings, material);
}

Mesh cone_mesh(const ImplicitShape& cone, int segments, int rings, int material) {
    std::vector<V2f> profile = {{0, -cone.height / 2}};
    for (int i = 0; i <= rings; ++i) {
        const float t = float(i) / float(rings);
        profile.emplace_back(cone.radius_bottom + t * (cone.radius_top - cone.radius_bottom),
                             (t - 0.5f) * cone.height);
    }
    if (cone.radius_top > 0) profile.emplace_back(0.0f, cone.height / 2);
    return revolved(profile, segments, material);
}

PixelCamera camera_of(const View& view, const Scene& scene, const RenderSpace& space) {
    CameraChoice choice;
    choice.explicit_view = true;
    choice.look_from = view.from;
    choice.look_at = view.at;
    choice.fov_degrees = view.fov_degrees;
    return pixel_camera(choose_camera(scene, space, choice), scene, space, 0, view.width,
                        view.height);
}

FrameResult render_scene(const Scene& scene, const View& view, const RenderConfig& config,
                         uint64_t seed, int threads) {
    const Workers workers(threads);
    Progress progress;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    const PixelCamera camera = camera_of(view, scene, space);
    const NextFrame next{camera, {}};
    return render_frame(posed, camera, fresh_seeds(seed, 0, view.width, view.height), config, &next,
                        workers, progress);
}

Scene cornell(const Material& block, const Material& light) {
    SceneBuilder b;
    const int white = b.add_material(lambert(V3f(0.75f)));
    const int red = b.add_material(lambert({0.6f, 0.06f, 0.05f}));
    const int green = b.add_material(lambert({0.12f, 0.45f, 0.1f}));
    const float h = 0.5f;
    b.add_quad({-h, -h, h}, {1, 0, 0}, {0, 0, -1}, white); // floor
    b.add_quad({-h, h, -h}, {1, 0, 0}, {0, 0, 1}, white);  // ceiling
    b.add_quad({-h, -h, -h}, {1, 0, 0}, {0, 1, 0}, white); // back
    b.add_quad({-h, -h, h}, {0, 0, -1}, {0, 1, 0}, red);   // left
    b.add_quad({h, -h, -h}, {0, 0, 1}, {0, 1, 0}, green);  // right
    b.add_sphere({-0.2, -0.3, 0}, 0.18, b.add_material(block));
    b.scene.meshes.push_back(cube(1, white));
    b.place_mesh(int(b.scene.meshes.size()) - 1, scaled({0.13, 0.25, 0.13}) *
                                                     rotated({0, 1, 0}, 0.3) *
                                                     translated({0.2, -0.249, -0.15}));
    b.add_quad({-0.12f, 0.499f, -0.12f}, {0.24f, 0, 0}, {0, 0, 0.24f}, b.add_material(light));
    return b.scene;
}

View cornell_view(int side) {
    return {{0, 0, 1.9}, {0, 0, 0}, 39, side, side};
}

double mean_of(const Image& image, const char* plane) {
    const Array2D<float>& pixels = *image.find(plane);
    return std::accumulate(pixels.values().begin(), pixels.values().end(), 0.0) /
           double(pixels.size());
}

} // namespace ql::reference
