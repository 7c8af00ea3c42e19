#include "reference/linespace_scenes.h"

#include <array>

namespace ql::reference {

namespace {

int add_material(Scene& scene, const V3f& albedo, const V3f& emission) {
    Material material;
    material.model = MaterialModel::phong;
    material.base_color = albedo;
    material.emission = emission;
    material.double_sided = true;
    scene.materials.push_back(material);
    return int(scene.materials.size()) - 1;
}

// A parallelogram, its front by the right-hand rule.
void add_quad(Scene& scene, int material, const V3f& corner, const V3f& u, const V3f& v) {
    Mesh mesh;
    mesh.material = material;
    mesh.positions = {corner, corner + u, corner + u + v, corner + v};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
    scene.meshes.push_back(mesh);
    Node node;
    node.meshes = {int(scene.meshes.size()) - 1};
    scene.nodes.push_back(node);
}

// A cube as one mesh, fronts outside.
void add_block(Scene& scene, int material, const V3f& lower, float side) {
    Mesh mesh;
    mesh.material = material;
    for (int i = 0; i < 8; ++i)
        mesh.positions.push_back(lower +
                                 V3f(float(i & 1), float(i >> 1 & 1), float(i >> 2)) * side);
    for (const auto& [a, b, c, d] :
         {std::array{0u, 4u, 6u, 2u}, std::array{1u, 3u, 7u, 5u}, std::array{0u, 1u, 5u, 4u},
          std::array{2u, 6u, 7u, 3u}, std::array{0u, 2u, 3u, 1u}, std::array{4u, 5u, 7u, 6u}}) {
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    }
    scene.meshes.push_back(mesh);
    Node node;
    node.meshes = {int(scene.meshes.size()) - 1};
    scene.nodes.push_back(node);
}

} // namespace

Scene box_scene(const BoxScene& box) {
    Scene scene;
    const auto s = float(box.size);
    const int wall = add_material(scene, V3f(box.albedo), box.emission);
    const int left = box.left == V3f(0) ? wall : add_material(scene, box.left, box.emission);
    int back = wall;
    if (box.has_mirror) {
        back = add_material(scene, V3f(0), V3f(0));
        scene.materials.back().kd = 0;
        scene.materials.back().kr = 0.9f;
    }
    const V3f x(s, 0, 0), y(0, s, 0), z(0, 0, s);
    add_quad(scene, left, V3f(0), y, z);
    add_quad(scene, wall, x, z, y);
    add_quad(scene, wall, V3f(0), z, x);
    add_quad(scene, wall, y, x, z);
    add_quad(scene, back, V3f(0), x, y);
    add_quad(scene, wall, z, y, x);
    if (box.has_plate)
        add_quad(scene, wall, V3f(0.35f, 0.06f, 0.35f) * s, V3f(0, 0, 0.3f) * s,
                 V3f(0.3f, 0, 0) * s);
    if (box.has_table)
        add_quad(scene, wall, V3f(0.002f, 0.5f, 0.002f) * s, V3f(0, 0, 0.996f) * s,
                 V3f(0.996f, 0, 0) * s);
    if (box.has_false_floor)
        add_quad(scene, wall, V3f(-0.001f, 0.1f, -0.001f) * s, V3f(0, 0, 1.002f) * s,
                 V3f(1.002f, 0, 0) * s);
    if (box.has_block) add_block(scene, wall, V3f(0.3f, -0.001f, 0.25f) * s, 0.3f * s);
    if (box.lamp_radius > 0) {
        ImplicitShape lamp;
        lamp.radius = box.lamp_radius * s;
        lamp.material = add_material(scene, V3f(0), V3f(1));
        scene.shapes.push_back(lamp);
        Node node;
        node.translation = V3d(0.4, 0.6, 0.5) * box.size;
        node.shapes = {int(scene.shapes.size()) - 1};
        scene.nodes.push_back(node);
    }
    for (const BoxScene::PointLight& light : box.lights) {
        Light point;
        point.intensity = V3d(light.intensity * box.size * box.size);
        scene.lights.push_back(point);
        Node node;
        node.translation = light.position * box.size;
        node.light = int(scene.lights.size()) - 1;
        scene.nodes.push_back(node);
    }
    return scene;
}

Scene tilted_square() {
    Scene scene;
    const V3f u = V3f(2, 1, 0.5f).normalized();
    const V3f v = u.cross(V3f(0.3f, -1, 2)).normalized();
    add_quad(scene, add_material(scene, V3f(0.5f), V3f(0)), (u + v) * -0.5f, u, v);
    return scene;
}

} // namespace ql::reference
