#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

using namespace testing_gltf;

// A GLB that uses a bit of everything.
std::string rich_glb() {
    GltfBuilder b;
    auto& attributes = b.primitive()["attributes"];
    attributes["NORMAL"] = b.accessor<int8_t>("VEC3", {0, 0, 127, 0, 0, 127, 0, 0, 127}, true);
    attributes["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
    b.doc["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", b.view<uint8_t>({2})}, {"componentType", 5121}}},
        {"values", {{"bufferView", b.view<float>({0, 5, 0})}}}};
    const int times = b.accessor<float>("SCALAR", {0, 1});
    const int places = b.accessor<float>("VEC3", {0, 0, 0, 2, 0, 0});
    b.doc["animations"] = {
        {{"samplers", {{{"input", times}, {"output", places}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
    b.doc["nodes"].push_back(
        {{"children", {2}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    b.doc["nodes"].push_back(
        {{"camera", 0}, {"extensions", {{"KHR_implicit_shapes", {{"shape", 0}}}}}});
    b.doc["scenes"][0]["nodes"] = {0, 1};
    b.doc["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 1}}}}};
    b.doc["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"}, {"spot", {{"outerConeAngle", 1}}}}};
    b.doc["extensions"]["KHR_implicit_shapes"]["shapes"] = {
        {{"type", "sphere"}, {"sphere", {{"radius", 1}}}}};
    b.material()["extensions"]["QL_materials_phong"] = {{"kd", 0.5}, {"ks", 0.5}};
    return b.glb();
}

// Success or an input error; anything else fails the test.
void expect_handled(const std::string& content, const ScratchFolder& folder) {
    const std::string path = folder.write("fuzz.glb", content);
    try {
        const LoadedScene loaded = load_gltf({path}, {}, Workers(1));
        EXPECT_FALSE(loaded.scene.meshes.empty() && loaded.scene.shapes.empty());
        world_from_nodes(loaded.scene, 0.5);
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::input) << error.what();
        EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
}

TEST(GltfFuzz, TruncatedFilesAreErrors) {
    const std::string glb = rich_glb();
    ASSERT_EQ(error_of_text(glb, "test.glb"), "");
    for (size_t part = 0; part < 16; ++part)
        EXPECT_NE(error_of_text(glb.substr(0, glb.size() * part / 16), "test.glb"), "") << part;
}

TEST(GltfFuzz, NoChangedByteBringsItDown) {
    const std::string glb = rich_glb();
    const ScratchFolder folder;
    uint64_t state = 12345;
    const auto next = [&] { // splitmix64
        uint64_t z = state += 0x9e3779b97f4a7c15ull;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
        return z ^ (z >> 31);
    };
    for (int trial = 0; trial < 2000; ++trial) {
        std::string changed = glb;
        const size_t at = next() % glb.size();
        // Bits in one half of the trials, digits (which keep the JSON readable) in the other.
        changed[at] =
            trial % 2 == 0 ? char(changed[at] ^ (1 << next() % 8)) : char('0' + next() % 10);
        expect_handled(changed, folder);
    }
}

TEST(GltfFuzz, NoChangedNumberBringsItDown) {
    const std::string glb = rich_glb();
    const size_t json_size = size_t(uint8_t(glb[12])) | size_t(uint8_t(glb[13])) << 8;
    const json original = json::parse(glb.substr(20, json_size));
    const ScratchFolder folder;
    const json flat = original.flatten();
    const json replacements = {-1,   0,   7,       2147483648u,   18446744073709551615u, 1e300,
                               -0.5, "x", nullptr, json::array(), json::object(),        true};
    for (const auto& [pointer, value] : flat.items())
        for (const json& replacement : replacements) {
            json changed = original;
            changed[json::json_pointer(pointer)] = replacement;
            changed["buffers"][0]["uri"] =
                "data:application/octet-stream;base64," +
                base64(
                    std::vector<uint8_t>(glb.begin() + 28 + std::ptrdiff_t(json_size), glb.end()));
            expect_handled(changed.dump(), folder);
        }
}

} // namespace
} // namespace ql
