#include "unit/scene/gltf_builder.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ql {
namespace {

using namespace testing_gltf;

// 2 x 1 pixels: red, and blue at half opacity. PNG, 8 bit RGBA.
const char* kPng =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAABCAYAAAD0In+KAAAADklEQVR4nGP4"
    "z8AAQg0AD3oDfnfpf5cAAAAASUVORK5CYII=";

GltfBuilder textured() {
    GltfBuilder b;
    b.primitive()["attributes"]["TEXCOORD_0"] = b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
    b.doc["images"] = {{{"uri", kPng}}};
    b.doc["textures"] = {{{"source", 0}}};
    b.material()["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", 0}};
    return b;
}

Material material_of(const GltfBuilder& b) {
    return load(b).scene.materials.at(0);
}

TEST(GltfMaterial, FactorsOfMetallicRoughnessAreRead) {
    GltfBuilder b;
    b.material() = json::parse(R"({"name": "m", "doubleSided": true, "alphaMode": "MASK",
        "alphaCutoff": 0.25, "emissiveFactor": [0.5, 0.25, 0],
        "pbrMetallicRoughness": {"baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5,
                                 "roughnessFactor": 0.75},
        "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 8},
                       "KHR_materials_ior": {"ior": 1.3},
                       "KHR_materials_transmission": {"transmissionFactor": 0.5},
                       "KHR_materials_volume": {"thicknessFactor": 0.1}}})");
    const Material m = material_of(b);
    EXPECT_EQ(m.name, "m");
    EXPECT_EQ(m.model, MaterialModel::metallic_roughness);
    EXPECT_TRUE(m.double_sided);
    EXPECT_EQ(m.base_color, V3f(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(m.alpha, 0.4f);
    EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
    EXPECT_EQ(m.alpha_cutoff, 0.25f);
    EXPECT_EQ(m.emission, V3f(4, 2, 0));
    EXPECT_EQ(m.metallic, 0.5f);
    EXPECT_EQ(m.roughness, 0.75f);
    EXPECT_EQ(m.ior, 1.3f);
    EXPECT_EQ(m.transmission, 0.5f);
    EXPECT_FALSE(m.thin_walled);
}

TEST(GltfMaterial, PhongIsRead) {
    GltfBuilder b;
    b.material()["extensions"]["QL_materials_phong"] =
        json::parse(R"({"kd": 0.25, "ks": 0.25, "kr": 0.125, "kt": 0.375, "exponent": 40,
        "ior": 1.45, "diffuseColor": [1, 0.5, 0], "specularColor": [0, 0.5, 1],
        "fresnel": "schlick"})");
    const Material m = material_of(b);
    EXPECT_EQ(m.model, MaterialModel::phong);
    EXPECT_EQ(m.kd, 0.25f);
    EXPECT_EQ(m.ks, 0.25f);
    EXPECT_EQ(m.kr, 0.125f);
    EXPECT_EQ(m.kt, 0.375f);
    EXPECT_EQ(m.exponent, 40);
    EXPECT_EQ(m.ior, 1.45f);
    EXPECT_EQ(m.base_color, V3f(1, 0.5f, 0));
    EXPECT_EQ(m.specular_color, V3f(0, 0.5f, 1));
    EXPECT_EQ(m.fresnel, FresnelModel::schlick);
}

TEST(GltfMaterial, PhongThatCreatesEnergyIsRefused) {
    GltfBuilder b;
    b.material()["extensions"]["QL_materials_phong"] = {{"kd", 0.75}, {"ks", 0.5}};
    EXPECT_EQ(error_of(b),
              "material 0 QL_materials_phong: kd + ks + kr + kt is 1.25, expected at most 1");
}

TEST(GltfMaterial, FactorsOutsideTheirRangeAreMovedWithAWarning) {
    GltfBuilder b;
    b.material()["pbrMetallicRoughness"] = {{"roughnessFactor", 2}, {"metallicFactor", -1}};
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.scene.materials[0].roughness, 1);
    EXPECT_EQ(loaded.scene.materials[0].metallic, 0);
    EXPECT_TRUE(warned(loaded, "material 0 roughnessFactor is 2, outside [0, 1]"));
}

TEST(GltfMaterial, EmissionAboveOneIsKeptWithAWarning) {
    GltfBuilder b;
    b.material()["emissiveFactor"] = {10, 10, 10};
    const LoadedScene loaded = load(b);
    EXPECT_EQ(loaded.scene.materials[0].emission, V3f(10));
    EXPECT_TRUE(warned(loaded, "emissiveFactor is above 1"));
}

TEST(GltfMaterial, UnlitNeedsNothingButItsColour) {
    GltfBuilder b = textured();
    b.material()["extensions"]["KHR_materials_unlit"] = json::object();
    b.material()["emissiveFactor"] = {1, 1, 1};
    const Material m = material_of(b);
    EXPECT_EQ(m.model, MaterialModel::unlit);
    EXPECT_TRUE(m.base_color_texture.used());
    EXPECT_EQ(m.emission, V3f(0));
}

TEST(GltfMaterial, SpecularGlossinessIsConverted) {
    GltfBuilder dielectric, metal;
    dielectric.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"] =
        json::parse(R"({"diffuseFactor": [0.4, 0.2, 0.1, 1], "specularFactor": [0.04, 0.04, 0.04],
                        "glossinessFactor": 0.25})");
    metal.material()["extensions"]["KHR_materials_pbrSpecularGlossiness"] =
        json::parse(R"({"diffuseFactor": [0, 0, 0, 1], "specularFactor": [0.9, 0.6, 0.3]})");
    const Material d = material_of(dielectric);
    EXPECT_EQ(d.metallic, 0);
    EXPECT_EQ(d.roughness, 0.75f);
    EXPECT_NEAR(d.base_color.x, 0.4, 1e-6);
    const Material m = material_of(metal);
    EXPECT_EQ(m.metallic, 1);
    EXPECT_EQ(m.roughness, 0);
    EXPECT_NEAR(m.base_color.y, 0.6, 1e-6);
}

TEST(GltfMaterial, TexelsAndTheirTransferAreRead) {
    const Scene scene = load(textured()).scene;
    ASSERT_EQ(scene.textures.size(), 1u);
    const Texture& texture = scene.textures[0];
    EXPECT_EQ(texture.width, 2);
    EXPECT_EQ(texture.height, 1);
    EXPECT_EQ(texture.texels, (std::vector<uint8_t>{255, 0, 0, 255, 0, 0, 255, 128}));
    const TextureUse& use = scene.materials[0].base_color_texture;
    EXPECT_EQ(use.transfer, Transfer::srgb);
    EXPECT_EQ(use.wrap_s, Wrap::repeat);
    EXPECT_EQ(use.filter, TextureFilter::bilinear);
}

TEST(GltfMaterial, SamplersAreRead) {
    GltfBuilder b = textured();
    b.doc["textures"][0]["sampler"] = 0;
    b.doc["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
    const TextureUse use = material_of(b).base_color_texture;
    EXPECT_EQ(use.wrap_s, Wrap::clamp);
    EXPECT_EQ(use.wrap_t, Wrap::mirrored_repeat);
    EXPECT_EQ(use.filter, TextureFilter::nearest);
}

// The example of the extension: the lower left quadrant, turned by a quarter.
TEST(GltfMaterial, TextureTransformFollowsItsExample) {
    GltfBuilder b = textured();
    b.primitive()["attributes"]["TEXCOORD_1"] = b.accessor<float>("VEC2", {0, 0, 1, 0, 0, 1});
    b.material()["pbrMetallicRoughness"]["baseColorTexture"]["extensions"]
                ["KHR_texture_transform"] = {{"offset", {0, 1}},
                                             {"rotation", std::numbers::pi / 2},
                                             {"scale", {0.5, 0.5}},
                                             {"texCoord", 1}};
    const TextureUse use = material_of(b).base_color_texture;
    EXPECT_EQ(use.uv_set, 1);
    const std::array<float, 6>& m = use.uv_transform;
    const auto mapped = [&](float u, float v) {
        return V2f(m[0] * u + m[1] * v + m[2], m[3] * u + m[4] * v + m[5]);
    };
    EXPECT_LT((mapped(0, 0) - V2f(0, 1)).length(), 1e-6f);
    EXPECT_LT((mapped(1, 0) - V2f(0, 0.5f)).length(), 1e-6f);
    EXPECT_LT((mapped(0, 1) - V2f(0.5f, 1)).length(), 1e-6f);
}

TEST(GltfMaterial, TexturesThatCannotBeSeenAreNotDecoded) {
    GltfBuilder b = textured();
    b.doc["images"][0]["uri"] = "data:image/png;base64,AAAA";
    b.doc["materials"].push_back(b.doc["materials"][0]);                // the bad one, unused
    b.material() = json::parse(R"({"emissiveTexture": {"index": 0}})"); // with a factor of zero
    EXPECT_TRUE(load(b).scene.textures.empty());
}

TEST(GltfMaterial, ImagesThatCannotBeDecodedAreNamed) {
    GltfBuilder b = textured();
    b.doc["images"][0] = {{"uri", "data:image/png;base64,AAAA"}, {"name", "wood"}};
    EXPECT_EQ(error_of(b), "image 0 (wood): unknown image format, expected PNG or JPEG");
    b.doc["images"][0] = {{"uri", "missing.png"}};
    EXPECT_EQ(error_of(b), "image 0 (missing.png): cannot be read");
    b.doc["images"][0] = {{"bufferView", 1000}};
    EXPECT_NE(error_of(b), "");
    b.doc["images"][0] = {{"bufferView", 0}, {"mimeType", "image/png"}};
    b.doc["bufferViews"][0]["byteLength"] = 100000;
    b.primitive()["attributes"].erase("NORMAL");
    EXPECT_NE(error_of(b).find("100000 bytes from offset 0 in a buffer of"), std::string::npos);
}

TEST(GltfMaterial, MissingTextureCoordinatesAreWarnedOf) {
    GltfBuilder b = textured();
    b.primitive()["attributes"].erase("TEXCOORD_0");
    EXPECT_TRUE(warned(load(b), "no TEXCOORD_0 for the textures of its material"));
}

TEST(GltfMaterial, BadReferencesAreErrors) {
    const auto with = [](auto change) {
        GltfBuilder b = textured();
        change(b);
        return error_of(b);
    };
    EXPECT_EQ(with([](GltfBuilder& b) { b.doc["textures"] = json::array(); }),
              "material 0 baseColorTexture: texture 0, but the file has 0");
    EXPECT_EQ(with([](GltfBuilder& b) { b.doc["textures"][0]["source"] = 9; }),
              "texture 0: image 9, but the file has 1");
    EXPECT_EQ(with([](GltfBuilder& b) { b.doc["textures"][0]["sampler"] = 2; }),
              "texture 0: sampler 2, but the file has 0");
    EXPECT_EQ(with([](GltfBuilder& b) { b.doc["textures"][0].erase("source"); }),
              "texture 0: no image");
    EXPECT_EQ(with([](GltfBuilder& b) { b.primitive()["material"] = 5; }),
              "mesh 0 primitive 0: material 5, but the file has 1");
    EXPECT_EQ(with([](GltfBuilder& b) { b.material()["alphaMode"] = "SOME"; }),
              "material 0: alphaMode SOME, expected OPAQUE, MASK or BLEND");
    EXPECT_EQ(with([](GltfBuilder& b) {
                  b.material()["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 2;
              }),
              "material 0 baseColorTexture: reads TEXCOORD_2, expected set 0 or 1");
    EXPECT_EQ(with([](GltfBuilder& b) {
                  b.material()["extensions"]["QL_materials_phong"] = {{"kd", "much"}};
              }),
              "material 0 QL_materials_phong kd is not a number");
}

} // namespace
} // namespace ql
