#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <functional>

namespace ql {
namespace {

using namespace testing_gltf;

struct BadFile {
    const char* error;
    std::function<void(GltfBuilder&)> change;
};

json& accessor(GltfBuilder& b, size_t index) {
    return b.doc["accessors"][index];
}

void make_sparse(GltfBuilder& b, int count, const std::vector<uint16_t>& indices) {
    accessor(b, 0)["sparse"] = {
        {"count", count},
        {"indices", {{"bufferView", b.view(indices)}, {"componentType", 5123}}},
        {"values", {{"bufferView", b.view<float>({0, 5, 0, 0, 6, 0})}}}};
}

const std::vector<BadFile> kBadFiles = {
    {"glTF version 1.0, expected 2.0", [](auto& b) { b.doc["asset"]["version"] = "1.0"; }},
    {"needs glTF version 2.1, expected 2.0", [](auto& b) { b.doc["asset"]["minVersion"] = "2.1"; }},
    {"requires the extension EXT_made_up, which is not supported",
     [](auto& b) {
         b.doc["extensionsRequired"] = {"KHR_materials_ior", "EXT_made_up"};
     }},
    // Bounds.
    {"accessor 0: 48 bytes from offset 0 in a buffer view of 36 bytes",
     [](auto& b) { accessor(b, 0)["count"] = 4; }},
    {"accessor 0: 36 bytes from offset 4 in a buffer view of 36 bytes",
     [](auto& b) { accessor(b, 0)["byteOffset"] = 4; }},
    {"accessor 0: 13835058055282163712 bytes from offset 0 in a buffer view of 36 bytes",
     [](auto& b) { accessor(b, 0)["count"] = size_t(1) << 60; }},
    {"accessor 0: 18446744073709551615 bytes from offset 0 in a buffer view of 36 bytes",
     [](auto& b) { accessor(b, 0)["count"] = size_t(1) << 62; }},
    {"accessor 0: 36 bytes from offset 18446744073709551615 in a buffer view of 36 bytes",
     [](auto& b) { accessor(b, 0)["byteOffset"] = ~size_t(0); }},
    {"accessor 0: 1152921504606846976 elements without a buffer view, more than the limit of "
     "16777216",
     [](auto& b) {
         accessor(b, 0)["count"] = size_t(1) << 60;
         accessor(b, 0).erase("bufferView");
     }},
    {"buffer view 0: 36 bytes from offset 1000 in a buffer of 42 bytes",
     [](auto& b) { b.doc["bufferViews"][0]["byteOffset"] = 1000; }},
    {"buffer view 0: 36 bytes from offset 18446744073709551600 in a buffer of 42 bytes",
     [](auto& b) { b.doc["bufferViews"][0]["byteOffset"] = 18446744073709551600u; }},
    {"accessor 0: byteStride 8, expected at least 12",
     [](auto& b) { b.doc["bufferViews"][0]["byteStride"] = 8; }},
    {"buffer view 0: buffer 3, but the file has 1",
     [](auto& b) { b.doc["bufferViews"][0]["buffer"] = 3; }},
    {"accessor 0: buffer view 9, but the file has 2",
     [](auto& b) { accessor(b, 0)["bufferView"] = 9; }},
    // Types.
    {"accessor 0: 2 components, expected 3 for mesh 0 primitive 0 POSITION",
     [](auto& b) { accessor(b, 0)["type"] = "VEC2"; }},
    {"accessor 1: component type 5126, expected unsigned scalars for the indices of mesh 0 "
     "primitive 0",
     [](auto& b) { accessor(b, 1)["componentType"] = 5126; }},
    {"accessor 2: integers that are not normalized, expected normalized ones for mesh 0 primitive "
     "0 COLOR_0",
     [](auto& b) {
         b.primitive()["attributes"]["COLOR_0"] =
             b.template accessor<uint8_t>("VEC3", {0, 0, 0, 0, 0, 0, 0, 0, 0});
     }},
    {"mesh 0 primitive 0 NORMAL: 1 values for 3 vertices",
     [](auto& b) {
         b.primitive()["attributes"]["NORMAL"] = b.template accessor<float>("VEC3", {0, 0, 1});
     }},
    // Indices.
    {"mesh 0 primitive 0: index 3 of 3 vertices",
     [](auto& b) {
         b.primitive()["indices"] = b.template accessor<uint16_t>("SCALAR", {0, 1, 3});
     }},
    {"mesh 0 primitive 0 POSITION: accessor 12, but the file has 2",
     [](auto& b) { b.primitive()["attributes"]["POSITION"] = 12; }},
    {"primitive indices accessor out of bounds", [](auto& b) { b.primitive()["indices"] = 12; }},
    {"mesh 0 primitive 0: mode 7, expected 0 to 6", [](auto& b) { b.primitive()["mode"] = 7; }},
    {"accessor 0: 4 sparse values in 3 elements",
     [](auto& b) {
         make_sparse(b, 4, {0, 1});
     }},
    {"accessor 0: sparse index 3 in 3 elements",
     [](auto& b) {
         make_sparse(b, 2, {0, 3});
     }},
    {"accessor 0: sparse index 1 after 1, expected ascending ones",
     [](auto& b) {
         make_sparse(b, 2, {1, 1});
     }},
    {"accessor 0 sparse indices: 4 bytes from offset 0 in a buffer view of 2 bytes",
     [](auto& b) { make_sparse(b, 2, {1}); }},
    {"accessor 0: -1 sparse values in 3 elements", [](auto& b) { make_sparse(b, -1, {1}); }},
    // The node tree.
    {"node 0: mesh 4, but the file has 1", [](auto& b) { b.node()["mesh"] = 4; }},
    {"node 0: camera 0, but the file has 0", [](auto& b) { b.node()["camera"] = 0; }},
    {"node 0: skin 0, but the file has 0", [](auto& b) { b.node()["skin"] = 0; }},
    {"node 0: child 8, but the file has 1", [](auto& b) { b.node()["children"] = {8}; }},
    {"node 0: its parents form a cycle", [](auto& b) { b.node()["children"] = {0}; }},
    {"node 1: its parents form a cycle",
     [](auto& b) {
         b.doc["nodes"].push_back({{"children", {2}}});
         b.doc["nodes"].push_back({{"children", {1}}});
     }},
    {"node 2: child of node 0 and of node 1",
     [](auto& b) {
         b.node()["children"] = {2};
         b.doc["nodes"].push_back({{"children", {2}}});
         b.doc["nodes"].push_back(json::object());
     }},
    {"scene 0: node 0 is listed twice",
     [](auto& b) {
         b.doc["scenes"][0]["nodes"] = {0, 0};
     }},
    {"scene 0: node 1 is a child of node 0, expected a root",
     [](auto& b) {
         b.node()["children"] = {1};
         b.doc["nodes"].push_back(json::object());
         b.doc["scenes"][0]["nodes"] = {0, 1};
     }},
    {"scene 0: node 5, but the file has 1", [](auto& b) { b.doc["scenes"][0]["nodes"] = {5}; }},
    {"default scene: scene 3, but the file has 1", [](auto& b) { b.doc["scene"] = 3; }},
    {"node 0 scale has 2 numbers, expected 3",
     [](auto& b) {
         b.node()["scale"] = {1, 2};
     }},
    {"node 0: rotation of length 0, expected 1",
     [](auto& b) {
         b.node()["rotation"] = {0, 0, 0, 0};
     }},
    {"node 0: matrix is not affine",
     [](auto& b) { b.node()["matrix"] = {1, 0, 0, 1, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}; }},
    // Compression without anything beside it.
    {"mesh 0 primitive 0: compressed with KHR_draco_mesh_compression without uncompressed data "
     "beside it, which is not supported",
     [](auto& b) {
         b.primitive()["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 0}};
         accessor(b, 0).erase("bufferView");
     }},
    {"no triangle and no shape to render",
     [](auto& b) { b.doc["scenes"][0]["nodes"] = json::array(); }},
};

TEST(GltfErrors, EachBadFileGetsOneLineThatSaysWhatAndWhere) {
    ASSERT_EQ(error_of(GltfBuilder()), "");
    for (const BadFile& bad : kBadFiles) {
        GltfBuilder b;
        bad.change(b);
        EXPECT_EQ(error_of(b), bad.error);
    }
}

TEST(GltfErrors, WhatIsNotGltfIsSaidToBeSo) {
    EXPECT_EQ(error_of_text(""), "empty file, expected glTF");
    EXPECT_EQ(error_of_text("\x89PNG\r\n"), "neither a GLB nor a JSON object, expected glTF");
    EXPECT_EQ(error_of_text("[1, 2]"), "neither a GLB nor a JSON object, expected glTF");
    EXPECT_EQ(error_of_text(R"({"asset": {}})"),
              R"("asset" object not found in .gltf or not an object type)");
    EXPECT_NE(error_of_text(R"({"asset": )").find("parse error"), std::string::npos);
}

TEST(GltfErrors, DeepNestingDoesNotExhaustTheStack) {
    std::string nested = R"({"asset": {"version": "2.0"}, "extras": )";
    nested += std::string(1000000, '[');
    EXPECT_EQ(error_of_text(nested), "JSON nested deeper than 128 levels");
}

TEST(GltfErrors, DeepNodeTreesAreFine) {
    GltfBuilder b;
    for (int i = 1; i < 50000; ++i)
        b.doc["nodes"].push_back({{"children", {i - 1}}});
    b.doc["scenes"][0]["nodes"] = {49999};
    EXPECT_EQ(load(b).scene.nodes.size(), 50000u);
}

TEST(GltfErrors, GlbHeadersAreChecked) {
    const std::string glb = GltfBuilder().glb();
    const auto with_byte = [&](size_t at, char value) {
        std::string changed = glb;
        changed[at] = value;
        return error_of_text(changed, "test.glb");
    };
    EXPECT_EQ(error_of_text(glb, "test.glb"), "");
    EXPECT_EQ(with_byte(4, 1), "GLB version 1, expected 2");
    EXPECT_NE(with_byte(11, 1).find("truncated to"), std::string::npos);
    EXPECT_NE(with_byte(14, 1).find("first GLB chunk has"), std::string::npos);
    EXPECT_NE(with_byte(16, 'X').find("expected JSON"), std::string::npos);
}

TEST(GltfErrors, OnlyTheFirstBufferOfAGlbMayLackASource) {
    GltfBuilder b;
    std::string glb = b.glb();
    const std::string one = "\"buffers\":[{\"byteLength\":42}]";
    ASSERT_NE(glb.find(one), std::string::npos);
    b.doc["bufferViews"][0]["buffer"] = 1;
    json whole = b.doc;
    whole["buffers"] = {{{"byteLength", 36}}, {{"byteLength", 36}}};
    std::string text = whole.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const size_t json_size = size_t(uint8_t(glb[12])) | size_t(uint8_t(glb[13])) << 8;
    std::string changed = glb.substr(0, 20) + text + glb.substr(20 + json_size);
    for (size_t k = 0; k < 4; ++k) {
        changed[8 + k] = char(changed.size() >> (8 * k));
        changed[12 + k] = char(text.size() >> (8 * k));
    }
    EXPECT_EQ(error_of_text(changed, "test.glb"), "buffer 1 has no data");
}

TEST(GltfErrors, FilesThatAreNotThereAreNamed) {
    GltfBuilder b;
    b.doc["buffers"] = {{{"byteLength", 42}, {"uri", "nowhere.bin"}}};
    EXPECT_NE(error_of(b).find("nowhere.bin"), std::string::npos);
}

TEST(GltfErrors, OptionalExtensionsAreWarnedOf) {
    GltfBuilder b;
    b.doc["extensionsUsed"] = {"EXT_made_up", "KHR_materials_ior"};
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.warnings.size(), 1u);
    EXPECT_TRUE(warned(loaded, "ignores the extension EXT_made_up"));
}

TEST(GltfErrors, AFileMayNotHaveMoreElementsThanTheLimit) {
    const ScratchFolder folder;
    const std::string path = folder.write("test.gltf", GltfBuilder().text());
    GltfLoadConfig config;
    config.max_elements = 5;
    EXPECT_THROW(load_gltf({path}, config, Workers(1)), Error);
    config.max_elements = 6;
    EXPECT_NO_THROW(load_gltf({path}, config, Workers(1)));
}

} // namespace
} // namespace ql
