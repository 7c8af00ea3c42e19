#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <numbers>

namespace ql {
namespace {

using namespace testing_gltf;

TEST(GltfNode, ParentsComeFirstAndTransformsMultiply) {
    GltfBuilder b;
    b.doc["nodes"] = json::parse(R"([
        {"mesh": 0, "translation": [1, 0, 0]},
        {"children": [0, 2], "scale": [2, 2, 2], "translation": [0, 0, 5]},
        {"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 3, 0, 0, 1]}])");
    b.doc["scenes"][0]["nodes"] = {1};
    const Scene scene = load(b).scene;
    ASSERT_EQ(scene.nodes.size(), 3u);
    EXPECT_EQ(scene.nodes[0].parent, -1);
    EXPECT_EQ(scene.nodes[1].parent, 0);
    EXPECT_EQ(scene.nodes[2].parent, 0);
    EXPECT_EQ(scene.meshes.size(), 1u); // shared
    const std::vector<M44d> world = world_from_nodes(scene, 0);
    EXPECT_EQ(V3d(1, 1, 1) * world[1], V3d(4, 2, 7));
    // The matrix turns x to y and moves by 3 along x.
    EXPECT_EQ(V3d(1, 0, 0) * world[2], V3d(6, 2, 5));
}

TEST(GltfNode, RotationsAreAsInGltf) {
    GltfBuilder b;
    const double h = std::sqrt(0.5);
    b.node()["rotation"] = {0, 0, h, h}; // 90 degrees about z
    const V3d turned = V3d(1, 0, 0) * world_from_nodes(load(b).scene, 0)[0];
    EXPECT_LT((turned - V3d(0, 1, 0)).length(), 1e-15);
}

TEST(GltfNode, OnlyTheDefaultSceneIsLoaded) {
    GltfBuilder b;
    b.doc["nodes"] = json::parse(R"([{"mesh": 0, "name": "a"}, {"mesh": 0, "name": "b"}])");
    b.doc["scenes"] = json::parse(R"([{"nodes": [0]}, {"nodes": [1]}])");
    b.doc["scene"] = 1;
    EXPECT_EQ(load(b).scene.nodes[0].name, "b");
    b.doc.erase("scene");
    EXPECT_EQ(load(b).scene.nodes[0].name, "a");
    b.doc.erase("scenes");
    EXPECT_EQ(load(b).scene.nodes.size(), 2u);
}

TEST(GltfNode, CamerasAreRead) {
    GltfBuilder b;
    b.doc["nodes"].push_back({{"camera", 0}, {"name", "eye"}});
    b.doc["nodes"].push_back({{"camera", 1}});
    b.doc["scenes"][0]["nodes"] = {0, 1, 2};
    b.doc["cameras"] = json::parse(R"([
        {"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.1, "aspectRatio": 1.5}},
        {"type": "orthographic", "name": "plan",
         "orthographic": {"xmag": 2, "ymag": -3, "znear": 0, "zfar": 1}}])");
    const Scene scene = load(b).scene;
    EXPECT_EQ(scene.cameras[0].name, "eye");
    EXPECT_EQ(scene.cameras[0].yfov, 0.7);
    EXPECT_EQ(scene.nodes[2].camera, 1);
    EXPECT_TRUE(scene.cameras[1].orthographic);
    EXPECT_EQ(scene.cameras[1].name, "plan");
    EXPECT_EQ(scene.cameras[1].ymag, 3);
    b.doc["cameras"][0]["perspective"]["yfov"] = 4;
    EXPECT_EQ(error_of(b), "camera 0: yfov 4, expected an angle between 0 and pi");
}

TEST(GltfNode, LightBeyondTheRangeIsBroughtDownToIt) {
    GltfBuilder b;
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] =
        json::parse(R"([{"type": "point", "intensity": 1e300, "color": [1, 1e300, 1e-270]}])");
    b.doc["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.doc["scenes"][0]["nodes"].push_back(1);
    b.material()["emissiveFactor"] = {1, 1, 0};
    b.material()["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", 3e38}};
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.scene.lights.at(0).intensity, V3d(1e40, 1e40, 1e300 * 1e-270));
    EXPECT_EQ(loaded.scene.materials.at(0).emission, V3f(1e38f, 1e38f, 0));
    EXPECT_EQ(loaded.warnings.size(), 3u);
}

TEST(GltfNode, LightsAreRead) {
    GltfBuilder b;
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] = json::parse(R"([
        {"type": "point", "intensity": 3, "color": [1, 0.5, 0], "range": 10},
        {"type": "spot", "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.2}},
        {"type": "spot", "spot": {"outerConeAngle": 1},
         "extensions": {"QL_lights_spot_exponent": {"exponent": 2}}},
        {"type": "directional", "intensity": 7}])");
    for (const int light : {0, 1, 2, 3}) {
        b.doc["nodes"].push_back({{"extensions", {{"KHR_lights_punctual", {{"light", light}}}}}});
        b.doc["scenes"][0]["nodes"].push_back(light + 1);
    }
    const LoadedScene loaded = load(b);
    const std::vector<Light>& lights = loaded.scene.lights;
    ASSERT_EQ(lights.size(), 4u);
    EXPECT_EQ(lights[0].kind, Light::Kind::point);
    EXPECT_EQ(lights[0].intensity, V3d(3, 1.5, 0));
    EXPECT_TRUE(warned(loaded, "light 0: its range is ignored"));
    EXPECT_EQ(lights[1].kind, Light::Kind::spot);
    EXPECT_EQ(lights[1].inner_angle, 0.1);
    EXPECT_EQ(lights[1].outer_angle, 0.2);
    EXPECT_FALSE(lights[1].exponent.has_value());
    EXPECT_EQ(lights[2].exponent, 2.0);
    EXPECT_EQ(lights[3].kind, Light::Kind::directional);
    EXPECT_EQ(lights[3].intensity, V3d(7));
    EXPECT_EQ(loaded.scene.nodes[4].light, 3);
    b.doc["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 4;
    EXPECT_EQ(error_of(b), "node 1: light 4, but the file has 4");
}

TEST(GltfNode, ImplicitShapesAreRead) {
    GltfBuilder b;
    b.doc["extensionsRequired"] = {"KHR_implicit_shapes", "QL_shape_material"};
    b.doc["extensions"]["KHR_implicit_shapes"]["shapes"] = json::parse(R"([
        {"type": "sphere", "sphere": {"radius": 2}},
        {"type": "cylinder", "cylinder": {"height": 3, "radiusBottom": 1, "radiusTop": 0}},
        {"type": "cylinder"}])");
    b.doc["nodes"] = json::parse(R"([
        {"extensions": {"KHR_implicit_shapes": {"shape": 0}, "QL_shape_material": {"material": 0}}},
        {"extensions": {"KHR_implicit_shapes": {"shape": 1}}},
        {"extensions": {"KHR_implicit_shapes": {"shape": 2}}}])");
    b.doc["scenes"][0]["nodes"] = {0, 1, 2};
    b.material()["name"] = "red";
    const Scene scene = load(b).scene;
    ASSERT_EQ(scene.shapes.size(), 3u);
    EXPECT_EQ(scene.shapes[0].kind, ImplicitShape::Kind::sphere);
    EXPECT_EQ(scene.shapes[0].radius, 2);
    EXPECT_EQ(scene.materials[size_t(scene.shapes[0].material)].name, "red");
    EXPECT_EQ(scene.shapes[1].kind, ImplicitShape::Kind::cone);
    EXPECT_EQ(scene.shapes[1].height, 3);
    EXPECT_EQ(scene.shapes[1].radius_bottom, 1);
    EXPECT_EQ(scene.shapes[1].radius_top, 0);
    EXPECT_EQ(scene.shapes[2].radius_top, 0.25f); // the extension's default
    EXPECT_EQ(scene.nodes[2].shapes, std::vector<int>{2});

    b.doc["extensions"]["KHR_implicit_shapes"]["shapes"][0] = {{"type", "box"}};
    EXPECT_EQ(error_of(b),
              "KHR_implicit_shapes shapes 0: type \"box\", expected sphere or cylinder");
    b.doc["extensions"]["KHR_implicit_shapes"]["shapes"] = json::array();
    EXPECT_EQ(error_of(b), "node 0 KHR_implicit_shapes: shape 0, but the file has 0");
}

TEST(GltfNode, AnimationsOfTheDefaultSceneAreRead) {
    GltfBuilder b;
    const int times = b.accessor<float>("SCALAR", {0, 1});
    const int places = b.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0});
    const int turns = b.accessor<int16_t>("VEC4", {0, 0, 0, 32767, 0, 0, 32767, 0}, true);
    b.doc["animations"] = {{{"samplers",
                             {{{"input", times}, {"output", places}},
                              {{"input", times}, {"output", turns}, {"interpolation", "STEP"}}}},
                            {"channels",
                             {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                              {{"sampler", 1}, {"target", {{"node", 0}, {"path", "rotation"}}}},
                              {{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    const LoadedScene loaded = load(b);
    const Scene& scene = loaded.scene;
    ASSERT_EQ(scene.animation.size(), 2u);
    EXPECT_EQ(scene.animation[0].times, (std::vector<double>{0, 1}));
    EXPECT_EQ(scene.animation[1].interpolation, AnimationChannel::Interpolation::step);
    EXPECT_EQ(scene.animation[1].values[1][2], 1);
    EXPECT_TRUE(warned(loaded, "weights are not animated"));
    EXPECT_EQ(V3d(0) * world_from_nodes(scene, 0.25)[0], V3d(0.5, 0, 0));

    json& sampler = b.doc["animations"][0]["samplers"][0];
    sampler["interpolation"] = "CUBICSPLINE";
    EXPECT_EQ(error_of(b), "animation 0 channel 0: 2 values for 2 keys, expected 6");
    sampler["interpolation"] = "LINEAR";
    sampler["input"] = b.accessor<float>("SCALAR", {1, 1});
    EXPECT_EQ(error_of(b),
              "animation 0 channel 0: time 1 of key 1, expected finite and ascending times");
    sampler["input"] = 99;
    EXPECT_NE(error_of(b).find("accessor 99, but the file has"), std::string::npos);
    sampler["input"] = times;
    b.doc["animations"][0]["channels"][0]["sampler"] = 7;
    EXPECT_EQ(error_of(b), "animation 0 channel 0: sampler 7, but the file has 2");
    b.doc["animations"][0]["channels"][0]["sampler"] = 0;
    b.node()["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_EQ(error_of(b), "animation 0 channel 0: moves node 0, which has a matrix");
}

} // namespace
} // namespace ql
