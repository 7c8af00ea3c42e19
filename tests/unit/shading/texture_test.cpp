#include "shading/texture.h"

#include <gtest/gtest.h>

#include <limits>

namespace ql {
namespace {

// 3 x 2 texels; red tells the column and green the row.
Texture numbered_texture() {
    Texture t;
    t.width = 3;
    t.height = 2;
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
            for (const int value : {x * 51, y * 51, 0, 255})
                t.texels.push_back(static_cast<uint8_t>(value));
    return t;
}

TextureUse nearest(Wrap wrap) {
    TextureUse use;
    use.texture = 0;
    use.wrap_s = use.wrap_t = wrap;
    use.filter = TextureFilter::nearest;
    return use;
}

int column(Wrap wrap, float u) {
    return static_cast<int>(
        std::lround(texture_value(numbered_texture(), nearest(wrap), {u, 0.1f}).x * 5));
}

TEST(TextureWrap, RepeatsForNegativeAndLargeCoordinates) {
    EXPECT_EQ(column(Wrap::repeat, 0.5f), 1);
    EXPECT_EQ(column(Wrap::repeat, 7.5f), 1);
    EXPECT_EQ(column(Wrap::repeat, -0.1f), 2);
    EXPECT_EQ(column(Wrap::repeat, -2.9f), 0);
    EXPECT_EQ(column(Wrap::repeat, 1.0f), 0);
    EXPECT_EQ(column(Wrap::repeat, -1e-30f), 2);
}

TEST(TextureWrap, MirrorsForNegativeAndLargeCoordinates) {
    EXPECT_EQ(column(Wrap::mirrored_repeat, 0.1f), 0);
    EXPECT_EQ(column(Wrap::mirrored_repeat, 1.1f), 2);
    EXPECT_EQ(column(Wrap::mirrored_repeat, 1.9f), 0);
    EXPECT_EQ(column(Wrap::mirrored_repeat, 2.1f), 0);
    EXPECT_EQ(column(Wrap::mirrored_repeat, -0.1f), 0);
    EXPECT_EQ(column(Wrap::mirrored_repeat, -0.9f), 2);
    EXPECT_EQ(column(Wrap::mirrored_repeat, -1.1f), 2);
}

TEST(TextureWrap, Clamps) {
    EXPECT_EQ(column(Wrap::clamp, -5), 0);
    EXPECT_EQ(column(Wrap::clamp, 0.9f), 2);
    EXPECT_EQ(column(Wrap::clamp, 1), 2);
    EXPECT_EQ(column(Wrap::clamp, 1e30f), 2);
}

TEST(TextureLookup, StaysInsideForAnyCoordinate) {
    const Texture texture = numbered_texture();
    const float inf = std::numeric_limits<float>::infinity();
    for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp})
        for (const TextureFilter filter : {TextureFilter::nearest, TextureFilter::bilinear})
            for (const float u : {1e30f, -1e30f, 3e38f, inf, -inf, std::nanf(""), 16777217.0f,
                                  -0.0f, 1e-40f, -1e-40f, 1 - 0x1p-24f, -0x1p-24f})
                for (const float v : {0.3f, -1e30f, inf}) {
                    TextureUse use = nearest(wrap);
                    use.filter = filter;
                    const V4f texel = texture_value(texture, use, {u, v});
                    EXPECT_TRUE(texel.x >= 0 && texel.x <= 0.41f) << u;
                    EXPECT_TRUE(texel.y >= 0 && texel.y <= 0.21f) << u;
                    EXPECT_FLOAT_EQ(texel.w, 1);
                }
    EXPECT_EQ(texture_value(texture, nearest(Wrap::clamp), {inf, 0.1f}).x, 0);
}

TEST(TextureLookup, InterpolatesBetweenTexelCentres) {
    TextureUse use = nearest(Wrap::repeat);
    use.filter = TextureFilter::bilinear;
    const Texture texture = numbered_texture();
    EXPECT_NEAR(texture_value(texture, use, {0.5f, 0.25f}).x, 0.2, 1e-6); // centre of column 1
    EXPECT_NEAR(texture_value(texture, use, {1.0f / 3, 0.25f}).x, 0.1, 1e-6);
    EXPECT_NEAR(texture_value(texture, use, {0.5f, 0.5f}).y, 0.1, 1e-6);
    // Across the border: the mean of columns 2 and 0, or column 0 alone.
    EXPECT_NEAR(texture_value(texture, use, {0, 0.25f}).x, 0.2, 1e-6);
    use.wrap_s = Wrap::mirrored_repeat;
    EXPECT_NEAR(texture_value(texture, use, {0, 0.25f}).x, 0, 1e-6);
    EXPECT_NEAR(texture_value(texture, use, {1, 0.25f}).x, 0.4, 1e-6);
    use.wrap_s = Wrap::clamp;
    EXPECT_NEAR(texture_value(texture, use, {0, 0.25f}).x, 0, 1e-6);
}

TEST(TextureLookup, DecodesSrgbBeforeItFiltersAndLeavesAlphaLinear) {
    Texture t;
    t.width = 2;
    t.height = 1;
    t.texels = {0, 188, 10, 0, 255, 188, 10, 128};
    TextureUse use = nearest(Wrap::clamp);
    use.filter = TextureFilter::bilinear;
    use.transfer = Transfer::srgb;
    const V4f middle = texture_value(t, use, {0.5f, 0.5f});
    EXPECT_NEAR(middle.x, 0.5, 1e-6); // not 0.214
    EXPECT_NEAR(middle.y, std::pow((188 / 255.0 + 0.055) / 1.055, 2.4), 1e-6);
    EXPECT_NEAR(middle.z, 10 / 255.0 / 12.92, 1e-7);
    EXPECT_NEAR(middle.w, 64 / 255.0, 1e-6);
}

TEST(TextureLookup, AppliesTheTransformOfTheUse) {
    TextureUse use = nearest(Wrap::repeat);
    use.uv_transform = {0, 1, 0.5f, 1, 0, 0}; // swap u and v, then move by half
    const V4f texel = texture_value(numbered_texture(), use, {0.75f, 0.3f});
    EXPECT_NEAR(texel.x * 5, 2, 1e-5); // u' = 0.8
    EXPECT_NEAR(texel.y * 5, 1, 1e-5); // v' = 0.75
}

TEST(TextureLookup, ReadsTheUvSetOfTheUseAndWhiteWithoutATexture) {
    const std::vector<Texture> textures = {numbered_texture()};
    TextureUse use = nearest(Wrap::repeat);
    const std::array<V2f, 2> uv = {V2f(0.1f, 0.1f), V2f(0.9f, 0.1f)};
    EXPECT_NEAR(texture_or_white(textures, use, uv).x, 0, 1e-6);
    use.uv_set = 1;
    EXPECT_NEAR(texture_or_white(textures, use, uv).x, 0.4, 1e-6);
    EXPECT_EQ(texture_or_white(textures, TextureUse{}, uv), V4f(1, 1, 1, 1));
}

} // namespace
} // namespace ql
