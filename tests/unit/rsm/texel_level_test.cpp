// Blocks of texels against the texels themselves.
#include "rsm/texel_level.h"

#include "statistics/rsm_scenes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

using namespace rsm_test;

// A bumpy floor under the room's block, so that normals differ within blocks.
Builder bumpy_room() {
    Builder b = spot_room();
    const int grey = b.material(V3f(0.5f));
    for (int z = -8; z < 8; ++z)
        for (int x = -8; x < 8; ++x) {
            const double low = -0.95, high = low + 0.05 * ((x * 7 + z * 3) & 3);
            b.quad({x / 8.0, low, z / 8.0}, {0, high - low, 0.125}, {0.125, 0.02, 0}, grey);
        }
    return b;
}

TEST(RsmTexelLevel, PlacesAreTexelsOfTheMapAndBlocksHoldThem) {
    const Stage stage(spot_room(), 4, {0.9, 0.8, 0.9}, {0, 0, 0});
    for (const int size : {1, 7, 96, 97, 200}) {
        const auto maps = stage.maps({.size = size});
        const TexelLevel level = texel_levels(maps, MipLevels::first)[0][0];
        const int side = 1 << level.block_shift;
        ASSERT_EQ(level.blocks.size(), size_t(level.blocks_across) * size_t(level.blocks_across));
        for (float v = -0.25f; v <= 1.25f; v += 0.0625f)
            for (float u = -0.25f; u <= 1.25f; u += 0.0625f) {
                uint32_t texel, block, inside;
                level.find(&u, &v, 1, &texel, &block, &inside);
                EXPECT_EQ(inside, u >= 0 && u <= 1 && v >= 0 && v <= 1 ? 1u : 0u);
                const int row = std::clamp(int(std::floor(v * float(size))), 0, size - 1);
                const int column = std::clamp(int(std::floor(u * float(size))), 0, size - 1);
                EXPECT_EQ(int(texel), row * size + column);
                EXPECT_EQ(int(block), row / side * level.blocks_across + column / side);
            }
        const float u = std::nanf(""), v = 0.5f;
        uint32_t texel, block, inside;
        level.find(&u, &v, 1, &texel, &block, &inside);
        EXPECT_EQ(inside, 0u);
        EXPECT_LT(texel, level.records.size());
    }
}

TEST(RsmTexelLevel, BlocksThatLightNothingHoldNoTexelThatDoes) {
    uint64_t skipped = 0, unlit = 0;
    for (const bool bumpy : {false, true}) {
        const Stage stage(bumpy ? bumpy_room() : spot_room(), 12, {0.9, 0.8, 0.9},
                          {-0.3, -0.5, -0.3});
        const auto maps = stage.maps({.size = 200});
        const auto levels = texel_levels(maps, MipLevels::all);
        for (const TexelLevel& level : levels[0])
            for (const Receiver& receiver : stage.receivers())
                for (int y = 0; y < level.size; y += 3)
                    for (int x = 0; x < level.size; x += 3) {
                        const float u = (float(x) + 0.5f) / float(level.size);
                        const float v = (float(y) + 0.5f) / float(level.size);
                        uint32_t number, block, inside;
                        level.find(&u, &v, 1, &number, &block, &inside);
                        const TexelRecord& texel = level.records[number];
                        const float term =
                            bounded_geometry(receiver, texel.position, texel.normal, 0, {});
                        unlit += term > 0 ? 0 : 1;
                        if (level.blocks[block].may_light(receiver)) continue;
                        ++skipped;
                        // But for what rounding leaves of a texel in the receiver's plane.
                        const V3f way = texel.position - receiver.position;
                        EXPECT_LE(term * way.dot(way) * way.dot(way), 2e-6f);
                    }
    }
    // Most of those that do not.
    EXPECT_GT(double(skipped) / double(unlit), 0.5);
}

TEST(RsmTexelLevel, ABlockWithoutFluxLightsNothing) {
    EXPECT_FALSE(TexelBlock().may_light({}));
    const TexelLevel level(Texels(25), 5);
    for (const TexelBlock& block : level.blocks)
        EXPECT_FALSE(block.may_light({{0.1f, 0.2f, 0.3f}, {0, 0, 1}, {0, 0, 1}, 0}));
}

} // namespace
} // namespace ql
