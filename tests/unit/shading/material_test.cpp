#include "shading/material.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

Texture plain_texture(uint8_t r, uint8_t g, uint8_t b, uint8_t a) {
    Texture t;
    t.width = t.height = 1;
    t.texels = {r, g, b, a};
    return t;
}

TextureUse use_of(int texture, Transfer transfer) {
    TextureUse use;
    use.texture = texture;
    use.transfer = transfer;
    return use;
}

Material dielectric(float ior) {
    Material m;
    m.metallic = 0;
    m.ior = ior;
    return m;
}

TEST(LobesOf, AreOnlyThoseThatTheMaterialCanHave) {
    constexpr uint32_t kCoated = kLobeDiffuse | kLobeMicrofacet;
    EXPECT_EQ(lobes_of(dielectric(1)), kLobeDiffuse);
    EXPECT_EQ(lobes_of(dielectric(1.5f)), kCoated);
    EXPECT_EQ(lobes_of(Material{}), kLobeMicrofacet); // metallic 1
    Material textured;
    textured.metallic_roughness_texture = use_of(0, Transfer::linear);
    EXPECT_EQ(lobes_of(textured), kCoated);
    Material glass = dielectric(1.5f);
    glass.transmission = 1;
    EXPECT_EQ(lobes_of(glass), kLobeTransmission | kLobeMicrofacet);

    Material phong;
    phong.model = MaterialModel::phong;
    EXPECT_EQ(lobes_of(phong), kLobeDiffuse);
    phong.ks = 0.5f;
    phong.kt = 0.1f;
    EXPECT_EQ(lobes_of(phong), kLobeDiffuse | kLobePhong | kLobeSpecular);
    Material unlit;
    unlit.model = MaterialModel::unlit;
    EXPECT_EQ(lobes_of(unlit), 0u);
}

// A point never has a lobe that its material did not announce.
TEST(BsdfAt, HasOnlyAnnouncedLobes) {
    const std::vector<Texture> textures = {plain_texture(255, 128, 64, 255)};
    for (const float metallic : {0.0f, 0.5f, 1.0f})
        for (const float transmission : {0.0f, 0.5f, 1.0f})
            for (const float ior : {0.0f, 1.0f, 1.5f})
                for (const int texture : {-1, 0}) {
                    Material m = dielectric(ior);
                    m.metallic = metallic;
                    m.transmission = transmission;
                    m.metallic_roughness_texture = use_of(texture, Transfer::linear);
                    m.transmission_texture = use_of(texture, Transfer::linear);
                    const uint32_t lobes = bsdf_at(textures, m, {}).lobes;
                    EXPECT_EQ(lobes & ~lobes_of(m), 0u);
                    EXPECT_NE(lobes, 0u);
                }
}

TEST(BsdfAt, ReadsTheChannelsThatGltfNames) {
    const std::vector<Texture> textures = {plain_texture(0, 51, 102, 255),
                                           plain_texture(255, 188, 0, 255),
                                           plain_texture(204, 0, 0, 0)};
    Material m;
    m.metallic = 0.5f;
    m.roughness = 0.5f;
    m.metallic_roughness_texture = use_of(0, Transfer::linear);
    m.base_color = {0.5f, 0.5f, 0.5f};
    m.base_color_texture = use_of(1, Transfer::srgb);
    m.transmission = 0.5f;
    m.transmission_texture = use_of(2, Transfer::linear);
    SurfaceInput input;
    input.color = {1, 0.5f, 1, 1};
    const Bsdf b = bsdf_at(textures, m, input);
    EXPECT_NEAR(b.metallic, 0.2, 1e-6); // 0.5 * 102/255
    EXPECT_NEAR(b.alpha, 0.01, 1e-6);   // (0.5 * 51/255)^2
    EXPECT_NEAR(b.metal_f0.x, 0.5, 1e-6);
    EXPECT_NEAR(b.metal_f0.y, 0.25 * kSrgbToLinear[188], 1e-6);
    EXPECT_NEAR(b.transmission.x, 0.5 * 0.8 * 0.4, 1e-6);
    EXPECT_NEAR(b.diffuse.x, 0.5 * 0.8 * 0.6, 1e-6);
    // Without textures only the factors and the vertex colour count.
    m.metallic_roughness_texture = m.base_color_texture = m.transmission_texture = {};
    EXPECT_NEAR(bsdf_at({}, m, input).alpha, 0.25, 1e-6);
    EXPECT_NEAR(bsdf_at({}, m, input).metal_f0.y, 0.25, 1e-6);
}

TEST(BsdfAt, MapsThePhongModel) {
    Material m;
    m.model = MaterialModel::phong;
    m.base_color = {0.5f, 1, 0};
    m.kd = 0.4f;
    m.ks = 0.3f;
    m.specular_color = {1, 0, 1};
    m.exponent = 40;
    m.kr = 0.1f;
    m.kt = 0.2f;
    m.ior = 1.45f;
    m.fresnel = FresnelModel::schlick;
    SurfaceInput back;
    back.front = false;
    const Bsdf b = bsdf_at({}, m, back);
    EXPECT_EQ(b.diffuse, V3f(0.2f, 0.4f, 0));
    EXPECT_EQ(b.phong, V3f(0.3f, 0, 0.3f));
    EXPECT_EQ(b.exponent, 40);
    EXPECT_EQ(b.mirror, V3f(0.1f));
    EXPECT_EQ(b.refraction, V3f(0.2f));
    EXPECT_TRUE(b.schlick);
    EXPECT_FALSE(b.entering);
    EXPECT_NEAR(relative_eta(b), 1 / 1.45, 1e-6);
}

TEST(BsdfAt, KeepsTheOuterIndexOnTheBackOfOpaqueSurfaces) {
    Material m = dielectric(1.5f);
    m.thin_walled = false;
    SurfaceInput back;
    back.front = false;
    EXPECT_EQ(relative_eta(bsdf_at({}, m, back)), 1.5f);
    m.transmission = 1;
    EXPECT_NEAR(relative_eta(bsdf_at({}, m, back)), 1 / 1.5, 1e-6);
}

TEST(EmissionAt, ComesFromTheFrontUnlessDoubleSided) {
    const std::vector<Texture> textures = {plain_texture(255, 0, 188, 255)};
    Material m;
    m.emission = {2, 3, 4};
    SurfaceInput back;
    back.front = false;
    EXPECT_EQ(emission_at({}, m, {}), V3f(2, 3, 4));
    EXPECT_EQ(emission_at({}, m, back), V3f(0));
    m.double_sided = true;
    EXPECT_EQ(emission_at({}, m, back), V3f(2, 3, 4));
    m.emission_texture = use_of(0, Transfer::srgb);
    EXPECT_EQ(emission_at(textures, m, {}), V3f(2, 0, 4 * kSrgbToLinear[188]));
}

TEST(EmissionAt, IsTheBaseColourOfUnlitSurfaces) {
    Material m;
    m.model = MaterialModel::unlit;
    m.base_color = {0.1f, 0.2f, 0.3f};
    EXPECT_EQ(emission_at({}, m, {}), V3f(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(bsdf_at({}, m, {}).lobes, 0u);
    EXPECT_EQ(bsdf_at({}, m, {}).diffuse, V3f(0));
}

TEST(AlphaAt, FollowsTheAlphaMode) {
    const std::vector<Texture> textures = {plain_texture(255, 255, 255, 102)};
    Material m;
    m.alpha = 0.9f;
    m.base_color_texture = use_of(0, Transfer::srgb);
    EXPECT_EQ(alpha_at(textures, m, {}), 1);
    m.alpha_mode = AlphaMode::blend;
    EXPECT_NEAR(alpha_at(textures, m, {}), 0.36, 1e-6);
    m.alpha_mode = AlphaMode::mask;
    EXPECT_EQ(alpha_at(textures, m, {}), 0);
    m.alpha_cutoff = 0.3f;
    EXPECT_EQ(alpha_at(textures, m, {}), 1);
}

TEST(AlbedoAt, IsDiffusePlusSpecularColour) {
    Material m = dielectric(1);
    m.base_color = {0.2f, 0.4f, 0.6f};
    EXPECT_EQ(albedo_at({}, m, {}), V3f(0.2f, 0.4f, 0.6f));
    m.metallic = 1;
    EXPECT_EQ(albedo_at({}, m, {}), V3f(0.2f, 0.4f, 0.6f));
    m = dielectric(1.5f);
    m.base_color = V3f(0.5f);
    EXPECT_NEAR(albedo_at({}, m, {}).x, 0.5 * 0.96 + 0.04, 1e-6);
    m.transmission = 1;
    m.base_color = V3f(1);
    EXPECT_NEAR(albedo_at({}, m, {}).x, 1, 1e-6);
}

TEST(ShadingNormal, FollowsTheTextureInTheTangentFrame) {
    // x = 0.6, y = 0, z = 0.8 in 8 bits: 204, 127.5, 229.5.
    const std::vector<Texture> textures = {plain_texture(204, 128, 230, 255),
                                           plain_texture(128, 204, 230, 255)};
    Material m;
    m.normal_texture = use_of(0, Transfer::linear);
    const V3f n(0, 0, 1);
    const V3f along_x = shading_normal(textures, m, {}, n, {1, 0, 0, 1});
    EXPECT_NEAR(along_x.x, 0.6, 0.01);
    EXPECT_NEAR(along_x.z, 0.8, 0.01);
    EXPECT_NEAR(along_x.length(), 1, 1e-6);
    // The bitangent is the cross product of normal and tangent times the sign.
    m.normal_texture.texture = 1;
    EXPECT_NEAR(shading_normal(textures, m, {}, n, {1, 0, 0, 1}).y, 0.6, 0.01);
    EXPECT_NEAR(shading_normal(textures, m, {}, n, {1, 0, 0, -1}).y, -0.6, 0.01);
    m.normal_scale = 0;
    EXPECT_NEAR(shading_normal(textures, m, {}, n, {1, 0, 0, 1}).z, 1, 1e-6);
}

TEST(ShadingNormal, StaysWhereItCannotBeTurned) {
    const std::vector<Texture> textures = {plain_texture(204, 128, 230, 255)};
    Material m;
    const V3f n(0, 1, 0);
    EXPECT_EQ(shading_normal(textures, m, {}, n, {1, 0, 0, 1}), n);
    m.normal_texture = use_of(0, Transfer::linear);
    EXPECT_EQ(shading_normal(textures, m, {}, n, {0, 0, 0, 1}), n); // no tangent
    EXPECT_EQ(shading_normal(textures, m, {}, n, {0, 2, 0, 1}), n); // along the normal
}

} // namespace
} // namespace ql
