#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ql {
namespace {

using namespace testing_gltf;
using Triangles = std::vector<std::array<uint32_t, 3>>;

// Five points of a strip in the plane z = 0.
GltfBuilder strip_of_five(int mode) {
    GltfBuilder b;
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0});
    b.primitive().erase("indices");
    b.primitive()["mode"] = mode;
    return b;
}

TEST(GltfMesh, TriangleWithIndicesLoads) {
    const Scene scene = load(GltfBuilder()).scene;
    ASSERT_EQ(scene.meshes.size(), 1u);
    EXPECT_EQ(scene.meshes[0].triangles, (Triangles{{0, 1, 2}}));
    EXPECT_EQ(scene.meshes[0].positions[1], V3f(1, 0, 0));
    EXPECT_TRUE(scene.meshes[0].normals.empty());
    EXPECT_EQ(scene.nodes[0].meshes, std::vector<int>{0});
}

TEST(GltfMesh, IndicesOfAllWidthsAndNoneMeanTheSame) {
    GltfBuilder bytes, words, none;
    bytes.primitive()["indices"] = bytes.accessor<uint8_t>("SCALAR", {0, 1, 2});
    words.primitive()["indices"] = words.accessor<uint32_t>("SCALAR", {0, 1, 2});
    none.primitive().erase("indices");
    for (const GltfBuilder& b : {bytes, words, none})
        EXPECT_EQ(load(b).scene.meshes[0].triangles, (Triangles{{0, 1, 2}}));
}

TEST(GltfMesh, StripsKeepTheirOrientation) {
    EXPECT_EQ(load(strip_of_five(5)).scene.meshes[0].triangles,
              (Triangles{{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}));
}

TEST(GltfMesh, FansTurnAboutTheFirstVertex) {
    GltfBuilder b = strip_of_five(6);
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
    EXPECT_EQ(load(b).scene.meshes[0].triangles, (Triangles{{1, 2, 0}, {2, 3, 0}}));
}

TEST(GltfMesh, PointsAndLinesAreLeftOutWithAWarning) {
    GltfBuilder b;
    json line = b.primitive();
    line["mode"] = 1;
    b.doc["meshes"][0]["primitives"].push_back(line);
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.scene.meshes.size(), 1u);
    EXPECT_TRUE(warned(loaded, "mesh 0 primitive 1: lines are not rendered"));
    b.primitive()["mode"] = 0;
    EXPECT_EQ(error_of(b), "no triangle and no shape to render");
}

TEST(GltfMesh, SparseValuesReplaceThoseOfTheBufferView) {
    GltfBuilder b;
    b.doc["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view<uint8_t>({2})}, {"componentType", 5121}}},
        {"values", {{"bufferView", b.view<float>({0, 5, 0})}}}};
    EXPECT_EQ(load(b).scene.meshes[0].positions[2], V3f(0, 5, 0));
}

TEST(GltfMesh, SparseValuesReplaceZerosWithoutABufferView) {
    GltfBuilder b;
    b.doc["accessors"][0].erase("bufferView");
    b.doc["accessors"][0]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", b.view<uint16_t>({1, 2})}, {"componentType", 5123}}},
        {"values", {{"bufferView", b.view<float>({7, 0, 0, 0, 8, 0})}}}};
    const Mesh mesh = load(b).scene.meshes[0];
    EXPECT_EQ(mesh.positions, (std::vector<V3f>{{0, 0, 0}, {7, 0, 0}, {0, 8, 0}}));
}

TEST(GltfMesh, InterleavedAttributesAreReadWithTheirStride) {
    GltfBuilder b;
    const int view = b.view<float>({0, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 1, 0, 3, 0, 0, 0, 1});
    b.doc["bufferViews"][size_t(view)]["byteStride"] = 24;
    for (const size_t offset : {size_t(0), size_t(12)})
        b.doc["accessors"].push_back({{"bufferView", view},
                                      {"byteOffset", offset},
                                      {"componentType", 5126},
                                      {"count", 3},
                                      {"type", "VEC3"}});
    b.primitive()["attributes"] = {{"POSITION", 2}, {"NORMAL", 3}};
    const Mesh mesh = load(b).scene.meshes[0];
    EXPECT_EQ(mesh.positions[2], V3f(0, 3, 0));
    EXPECT_EQ(mesh.normals, std::vector<V3f>(3, V3f(0, 0, 1)));
}

TEST(GltfMesh, QuantizedAttributesAreConverted) {
    GltfBuilder b;
    b.doc["extensionsRequired"] = {"KHR_mesh_quantization"};
    auto& attributes = b.primitive()["attributes"];
    attributes["POSITION"] = b.accessor<int16_t>("VEC3", {0, 0, 0, 300, 0, 0, 0, -200, 0});
    attributes["NORMAL"] = b.accessor<int8_t>("VEC3", {0, 0, 127, 0, 0, -128, 0, 0, 64}, true);
    attributes["TEXCOORD_0"] = b.accessor<uint16_t>("VEC2", {0, 65535, 65535, 0, 0, 0}, true);
    attributes["TEXCOORD_1"] = b.accessor<uint8_t>("VEC2", {2, 3, 0, 0, 0, 0});
    const LoadedScene loaded = load(b);
    const Mesh& mesh = loaded.scene.meshes[0];
    EXPECT_EQ(mesh.positions[1], V3f(300, 0, 0));
    EXPECT_EQ(mesh.positions[2], V3f(0, -200, 0));
    EXPECT_EQ(mesh.normals, (std::vector<V3f>{{0, 0, 1}, {0, 0, -1}, {0, 0, 1}}));
    EXPECT_EQ(mesh.uvs[0][0], V2f(0, 1));
    EXPECT_EQ(mesh.uvs[1][0], V2f(2, 3));
    EXPECT_TRUE(loaded.warnings.empty());
}

TEST(GltfMesh, VertexColoursOfAllKindsBecomeFloats) {
    GltfBuilder rgb, rgba, bytes;
    rgb.primitive()["attributes"]["COLOR_0"] =
        rgb.accessor<float>("VEC3", {1, 0.5, 0, 0, 0, 0, 0, 0, 0});
    rgba.primitive()["attributes"]["COLOR_0"] =
        rgba.accessor<uint16_t>("VEC4", {65535, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, true);
    bytes.primitive()["attributes"]["COLOR_0"] =
        bytes.accessor<uint8_t>("VEC4", {0, 255, 51, 255, 0, 0, 0, 0, 0, 0, 0, 0}, true);
    EXPECT_EQ(load(rgb).scene.meshes[0].colors[0], V4f(1, 0.5f, 0, 1));
    EXPECT_EQ(load(rgba).scene.meshes[0].colors[0], V4f(1, 0, 0, 0));
    EXPECT_EQ(load(bytes).scene.meshes[0].colors[0], V4f(0, 1, 0.2f, 1));
}

TEST(GltfMesh, NonFiniteVerticesGoWithTheirTrianglesAndAreCounted) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    GltfBuilder b;
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>("VEC3", {0, 0, 0, nan, 0, 0, 0, 1, 0, 1, 0, 0});
    b.primitive()["indices"] = b.accessor<uint16_t>("SCALAR", {0, 1, 2, 0, 3, 2});
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.scene.non_finite_vertices, 1u);
    EXPECT_EQ(loaded.scene.meshes[0].positions.size(), 3u);
    EXPECT_EQ(loaded.scene.meshes[0].triangles, (Triangles{{0, 2, 1}}));
    EXPECT_TRUE(warned(loaded, "1 vertices that are not finite"));
}

TEST(GltfMesh, TrianglesWithoutAreaAreCountedAndDropped) {
    GltfBuilder b;
    b.primitive()["indices"] = b.accessor<uint16_t>("SCALAR", {0, 1, 2, 0, 1, 1, 2, 2, 2});
    const Scene scene = load(b).scene;
    EXPECT_EQ(scene.degenerate_triangles, 2u);
    EXPECT_EQ(scene.meshes[0].triangles.size(), 1u);
}

TEST(GltfMesh, TinyTrianglesAreKept) {
    GltfBuilder b;
    b.primitive()["attributes"]["POSITION"] =
        b.accessor<float>("VEC3", {0, 0, 0, 1e-30f, 0, 0, 0, 1e-30f, 0});
    EXPECT_EQ(load(b).scene.degenerate_triangles, 0u);
}

TEST(GltfMesh, NormalsGetUnitLengthAndZeroOnesThatOfTheSurface) {
    GltfBuilder b;
    b.primitive()["attributes"]["NORMAL"] =
        b.accessor<float>("VEC3", {0, 3, 4, 0, 0, 0, 1e-20f, 0, 0});
    const LoadedScene loaded = load(b);
    const std::vector<V3f>& normals = loaded.scene.meshes[0].normals;
    EXPECT_FLOAT_EQ(normals[0].y, 0.6f);
    EXPECT_EQ(normals[1], V3f(0, 0, 1));
    EXPECT_EQ(normals[2], V3f(1, 0, 0));
    EXPECT_TRUE(warned(loaded, "1 normals, tangents"));
}

TEST(GltfMesh, TangentsNeedNormals) {
    GltfBuilder b;
    auto& attributes = b.primitive()["attributes"];
    attributes["TANGENT"] = b.accessor<float>("VEC4", {2, 0, 0, 1, 2, 0, 0, -1, 2, 0, 0, 1});
    EXPECT_TRUE(load(b).scene.meshes[0].tangents.empty());
    attributes["NORMAL"] = b.accessor<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
    EXPECT_EQ(load(b).scene.meshes[0].tangents[1], V4f(1, 0, 0, -1));
}

TEST(GltfMesh, MeshesWithoutMaterialGetTheDefaultOne) {
    GltfBuilder b;
    b.primitive().erase("material");
    const Scene scene = load(b).scene;
    ASSERT_EQ(scene.materials.size(), 1u);
    EXPECT_EQ(scene.materials[0].metallic, 1);
    EXPECT_EQ(scene.materials[0].base_color, V3f(1));
}

TEST(GltfMesh, MorphTargetsAndSkinsAreAtRestWithAWarning) {
    GltfBuilder b;
    b.primitive()["targets"] = {{{"POSITION", 0}}};
    b.node()["skin"] = 0;
    b.doc["skins"] = {{{"joints", {0}}}};
    const LoadedScene loaded = load(b);
    EXPECT_TRUE(warned(loaded, "mesh 0: morph targets are not applied"));
    EXPECT_TRUE(warned(loaded, "node 0: its skin is not applied"));
    EXPECT_EQ(loaded.scene.meshes[0].positions[1], V3f(1, 0, 0));
}

TEST(GltfMesh, GlbAndJsonGiveTheSameScene) {
    const GltfBuilder b;
    const Scene from_glb = load_text(b.glb(), "test.glb").scene;
    const Scene from_json = load(b).scene;
    EXPECT_EQ(from_glb.meshes[0].positions, from_json.meshes[0].positions);
    EXPECT_EQ(from_glb.meshes[0].triangles, from_json.meshes[0].triangles);
}

TEST(GltfMesh, BuffersMayLieBesideTheFile) {
    GltfBuilder b;
    const ScratchFolder folder;
    folder.write("a b.bin", std::string(b.data.begin(), b.data.end()));
    b.doc["buffers"] = {{{"byteLength", b.data.size()}, {"uri", "a%20b.bin"}}};
    const std::string path = folder.write("scene.gltf", b.text());
    EXPECT_EQ(load_gltf({path}, {}, Workers(1)).scene.meshes.size(), 1u);
}

TEST(GltfMesh, SeveralFilesMakeOneWorld) {
    const ScratchFolder folder;
    GltfBuilder lights;
    lights.doc["nodes"] = json::parse(R"([{"extensions": {"KHR_lights_punctual": {"light": 0}}}])");
    lights.doc["extensions"] =
        json::parse(R"({"KHR_lights_punctual": {"lights": [{"type": "point"}]}})");
    const std::string a = folder.write("a.gltf", GltfBuilder().text());
    const std::string b = folder.write("b.gltf", lights.text());
    const Scene scene = load_gltf({a, b, a}, {}, Workers(1)).scene;
    EXPECT_EQ(scene.nodes.size(), 3u);
    EXPECT_EQ(scene.nodes[1].light, 0);
    EXPECT_EQ(scene.nodes[2].meshes, std::vector<int>{1});
    EXPECT_EQ(scene.meshes[1].material, 1);
}

} // namespace
} // namespace ql
