#include "scene/features.h"
#include "scene/scene_hash.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

namespace ql {
namespace {

// Two instances of one triangle, a sphere, a light and a camera.
Scene small_scene() {
    Scene scene;
    scene.textures.push_back({"t", 1, 1, {1, 2, 3, 4}});
    scene.materials.resize(2);
    scene.materials[0].base_color_texture.texture = 0;
    scene.materials[1].model = MaterialModel::phong;
    scene.materials[1].ks = 0.5f;
    scene.materials[1].emission = V3f(2);
    Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    scene.meshes.push_back(mesh);
    scene.shapes.resize(1);
    scene.shapes[0].material = 1;
    scene.lights.resize(1);
    scene.cameras.resize(1);
    scene.nodes.resize(3);
    scene.nodes[0].meshes = {0};
    scene.nodes[1].meshes = {0};
    scene.nodes[1].shapes = {0};
    scene.nodes[2].light = 0;
    scene.nodes[2].camera = 0;
    scene.animation.push_back({1,
                               AnimationChannel::Path::translation,
                               AnimationChannel::Interpolation::step,
                               {0},
                               {{5, 0, 0, 0}}});
    return scene;
}

TEST(SceneFeatures, AreCounted) {
    const SceneFeatures f = required_features(small_scene());
    EXPECT_EQ(f.triangles, 2u);
    EXPECT_EQ(f.unique_triangles, 1u);
    EXPECT_EQ(f.mesh_instances, 2u);
    EXPECT_EQ(f.spheres, 1u);
    EXPECT_EQ(f.textured_materials, 1u);
    EXPECT_EQ(f.phong_glossy_materials, 1u);
    EXPECT_EQ(f.phong_specular_materials, 0u);
    EXPECT_EQ(f.emissive_shapes, 1u);
    EXPECT_EQ(f.emissive_triangles, 0u);
    EXPECT_EQ(f.point_lights, 1u);
    EXPECT_EQ(f.cameras, 1u);
    EXPECT_EQ(f.animated_nodes, 1u);
}

TEST(SceneFeatures, UnusedMaterialsDoNotCount) {
    Scene scene = small_scene();
    scene.nodes[1].shapes.clear();
    EXPECT_EQ(required_features(scene).phong_diffuse_materials, 0u);
    EXPECT_TRUE(required_features(scene).has_light());
    scene.nodes[2].light = -1;
    EXPECT_FALSE(required_features(scene).has_light());
}

TEST(SceneFeatures, LineNamesWhatIsThere) {
    EXPECT_EQ(feature_line(required_features(small_scene())),
              "2 triangles (1 stored), 2 mesh instances, 1 sphere, 1 texture, "
              "1 metallic-roughness material, 1 Phong diffuse material, 1 Phong glossy material, "
              "1 emissive material, 1 textured material, 1 point light, 1 emissive shape, "
              "1 camera, 1 animated node");
}

TEST(SceneHash, IgnoresNamesAndCameras) {
    Scene scene = small_scene();
    const uint64_t before = scene_hash(scene);
    scene.materials[0].name = "other";
    scene.textures[0].name = "other";
    scene.nodes[0].name = "other";
    scene.cameras[0].yfov = 1.5;
    EXPECT_EQ(scene_hash(scene), before);
    scene.nodes.emplace_back();
    scene.nodes.back().camera = 0;
    EXPECT_EQ(scene_hash(scene), before);
}

TEST(SceneHash, SeesEveryChangeOfContent) {
    const std::vector<std::function<void(Scene&)>> changes = {
        [](Scene&) {},
        [](Scene& s) { s.textures[0].texels[3] = 5; },
        [](Scene& s) { s.textures[0].width = 2; },
        [](Scene& s) { s.materials[0].roughness = 0.5f; },
        [](Scene& s) { s.materials[0].alpha_mode = AlphaMode::mask; },
        [](Scene& s) { s.materials[0].base_color_texture.wrap_s = Wrap::clamp; },
        [](Scene& s) { s.materials[0].base_color_texture.uv_transform[2] = 0.5f; },
        [](Scene& s) { s.materials[1].fresnel = FresnelModel::schlick; },
        [](Scene& s) { s.materials[1].kt = 0.125f; },
        [](Scene& s) { s.meshes[0].positions[1].x = 1.0000001f; },
        [](Scene& s) {
            s.meshes[0].triangles[0] = {1, 2, 0};
        },
        [](Scene& s) { s.meshes[0].normals.resize(3, V3f(0, 0, 1)); },
        [](Scene& s) { s.meshes[0].uvs[0].resize(3); },
        [](Scene& s) { s.meshes[0].uvs[1].resize(3); },
        [](Scene& s) { s.meshes[0].material = 1; },
        [](Scene& s) { s.shapes[0].radius = 0.25f; },
        [](Scene& s) { s.lights[0].intensity.z = 2; },
        [](Scene& s) { s.lights[0].kind = Light::Kind::directional; },
        [](Scene& s) { s.nodes[2].translation.y = 1e-9; },
        [](Scene& s) { s.animation[0].values[0][0] = 6; },
        [](Scene& s) { s.nodes[0].meshes.clear(); },
    };
    std::set<uint64_t> hashes;
    for (const auto& change : changes) {
        Scene scene = small_scene();
        change(scene);
        hashes.insert(scene_hash(scene));
    }
    EXPECT_EQ(hashes.size(), changes.size());
}

// A cache made on one machine is read on another: the value itself must not change.
TEST(SceneHash, IsTheSameEverywhere) {
    EXPECT_EQ(scene_hash(Scene()), 8848935107335307795ull);
    EXPECT_EQ(scene_hash(small_scene()), 4469642974706910173ull);
}

} // namespace
} // namespace ql
