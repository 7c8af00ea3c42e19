#include "bluenoise/permute.h"

#include "bluenoise/retarget.h"
#include "bluenoise/retarget_solve.h"
#include "bluenoise/sort.h"
#include "reference/permute_reference.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace ql {
namespace {

Mask mask(int width, int height) {
    MaskConfig config;
    config.width = width;
    config.height = height;
    Progress progress;
    Mask mask{mask_ranks(config, progress), uint32_t(width * height), ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

// Textures of all motions up to `motions` for the steps of a kind of offsets.
std::vector<RetargetTexture> textures(const Mask& mask, OffsetKind kind, int motions) {
    RetargetConfig base;
    base.radius_px = 3;
    std::vector<RetargetTexture> result;
    for (const RetargetConfig& config :
         retarget_set(retarget_steps(mask_offsets(kind, mask.values.width(), mask.values.height())),
                      motions, base))
        result.push_back(exact_retarget_texture(mask, config));
    return result;
}

PermuteConfig permute_config(const Mask& mask, OffsetKind kind = OffsetKind::lattice) {
    PermuteConfig config;
    config.offsets = mask_offsets(kind, mask.values.width(), mask.values.height());
    return config;
}

Array2D<float> noise(int width, int height, uint32_t frame) {
    Array2D<float> values(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            values(x, y) = unit_float(hash32(99, uint32_t(x), uint32_t(y), frame)) - 0.25f;
    return values;
}

Array2D<uint32_t> words(int width, int height, uint32_t key) {
    Array2D<uint32_t> values(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            values(x, y) = hash32(key, uint32_t(x), uint32_t(y), 0);
    return values;
}

std::vector<uint32_t> sorted(const Array2D<uint32_t>& seeds) {
    std::vector<uint32_t> values = seeds.values();
    std::sort(values.begin(), values.end());
    return values;
}

MotionPlanes swirl(int width, int height, int frame) {
    MotionPlanes motion{Array2D<float>(width, height), Array2D<float>(width, height)};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            motion.x(x, y) =
                3 * std::sin(0.05f * float(y) + 0.7f * float(frame)) + 0.01f * float(x);
            motion.y(x, y) = 2 * std::cos(0.04f * float(x) - 0.3f * float(frame));
        }
    return motion;
}

TEST(Sort, EqualsItsSlowTwin) {
    const Array2D<uint32_t> ranks = mask(16, 24).values;
    for (const auto& [width, height] : {std::pair{64, 48}, {61, 67}, {1, 1}, {1, 7}, {5, 3}})
        for (const int block : {1, 2, 3, 4, 7, 8, 12, 16})
            for (const Imath::V2i& origin :
                 {Imath::V2i(0, 0), Imath::V2i(1, 2), Imath::V2i(-3, 9)}) {
                const Array2D<uint32_t> seeds = words(width, height, 1);
                const Array2D<float> intensities = noise(width, height, uint32_t(block));
                SortConfig config;
                config.block_px = block;
                config.origin = origin;
                config.mask_offset = {5, 11};
                // One surface; one of three at each pixel; some blocks of one, some of two
                Array2D<uint32_t> scattered = words(width, height, 7), halves(width, height, 4);
                for (uint32_t& surface : scattered.values())
                    surface %= 3;
                for (int y = 0; y < height; ++y)
                    for (int x = width / 2; x < width; ++x)
                        halves(x, y) = 9;
                for (const Array2D<uint32_t>& surfaces : {{}, scattered, halves}) {
                    Array2D<uint32_t> fast = seeds;
                    sort_seeds(fast, intensities, ranks, surfaces, config, Workers(2));
                    EXPECT_EQ(fast, reference::sorted_seeds(seeds, intensities, ranks, surfaces,
                                                            block, origin, {5, 11}))
                        << width << 'x' << height << " block " << block;
                }
            }
}

TEST(Sort, LargeBlocksEqualTheSlowTwin) {
    const Array2D<uint32_t> ranks = mask(64, 64).values;
    const Array2D<uint32_t> seeds = words(130, 70, 1);
    MaskConfig white;
    white.method = MaskMethod::white;
    white.width = 130;
    white.height = 70;
    Progress progress;
    const Array2D<uint32_t> order = mask_ranks(white, progress); // all differ
    const Array2D<float> intensities(130, 70, {order.values().begin(), order.values().end()});
    for (const int block : {17, 33, 64}) {
        SortConfig config;
        config.block_px = block;
        Array2D<uint32_t> fast = seeds;
        sort_seeds(fast, intensities, ranks, {}, config, Workers(2));
        EXPECT_EQ(fast,
                  reference::sorted_seeds(seeds, intensities, ranks, {}, block, {0, 0}, {0, 0}));
    }
}

// In an image of one intensity the order is a hash's: all frames differ, and no pixel keeps its
// seed more often than chance has it (1 of 64).
TEST(Sort, TiesAreBrokenByAHash) {
    const Array2D<uint32_t> ranks = mask(32, 32).values;
    const Array2D<uint32_t> seeds = words(64, 64, 1);
    int kept = 0;
    std::set<std::vector<uint32_t>> results;
    for (uint32_t key = 0; key < 16; ++key) {
        SortConfig config;
        config.tie_key = key * 0x9e3779b9u;
        Array2D<uint32_t> moved = seeds;
        sort_seeds(moved, Array2D<float>(64, 64, 0.5f), ranks, {}, config, Workers(1));
        for (size_t i = 0; i < seeds.size(); ++i)
            kept += moved[i] == seeds[i] ? 1 : 0;
        results.insert(moved.values());
    }
    EXPECT_EQ(results.size(), 16u);
    EXPECT_NEAR(kept / 65536.0, 1 / 64.0, 0.003);
}

TEST(Sort, UniqueRanksKeepTheOrder) {
    const Array2D<uint32_t> values(3, 2, {7, 7, 1, 9, 1, 7});
    const Array2D<uint32_t> ranks = unique_ranks(values);
    EXPECT_EQ(sorted(ranks), (std::vector<uint32_t>{0, 1, 2, 3, 4, 5}));
    for (size_t i = 0; i < 6; ++i)
        for (size_t j = 0; j < 6; ++j)
            EXPECT_EQ(values[i] < values[j] && ranks[i] > ranks[j], false);
}

TEST(Retarget, EqualsItsSlowTwin) {
    const Mask tile = mask(16, 8);
    for (const RetargetTexture& texture : textures(tile, OffsetKind::lattice, 1))
        for (const auto& [width, height] : {std::pair{16, 8}, {48, 64}, {160, 24}}) {
            const Array2D<uint32_t> seeds = words(width, height, 3);
            EXPECT_EQ(retargeted_seeds(seeds, texture.moves, {7, 3}, Workers(2)),
                      reference::retargeted_seeds(seeds, texture.moves, {7, 3}));
        }
}

TEST(Retarget, ByTileEqualsTheWholeWhereAllTilesMoveAlike) {
    const Mask tile = mask(16, 8);
    for (const RetargetTexture& texture : textures(tile, OffsetKind::lattice, 1)) {
        const Array2D<uint32_t> seeds = words(64, 32, 3);
        const std::vector<const Array2D<Imath::V2i>*> all(16, &texture.moves);
        EXPECT_EQ(retargeted_seeds_by_tile(seeds, all, {7, 3}, Workers(2)),
                  reference::retargeted_seeds(seeds, texture.moves, {7, 3}));
    }
}

TEST(Retarget, ByTileEqualsItsSlowTwin) {
    const Mask tile = mask(16, 8);
    const std::vector<RetargetTexture> set = textures(tile, OffsetKind::lattice, 4);
    for (const auto& [width, height] : {std::pair{16, 8}, {32, 8}, {48, 64}, {160, 24}}) {
        const Array2D<uint32_t> seeds = words(width, height, 3);
        std::vector<const Array2D<Imath::V2i>*> moves;
        for (uint32_t t = 0; t < uint32_t(width / 16 * (height / 8)); ++t)
            moves.push_back(&set[hash32(5, t, 0, 0) % set.size()].moves);
        EXPECT_EQ(retargeted_seeds_by_tile(seeds, moves, {7, 3}, Workers(2)),
                  reference::retargeted_seeds_by_tile(seeds, moves, {7, 3}));
    }
}

// Seeds sorted like M_t are nearly sorted like M_{t+1} afterwards: both axes and the signs matter.
TEST(Retarget, SeedsFollowTheMaskOnBothAxes) {
    const Mask tile = mask(32, 16);
    const int width = 96, height = 48;
    for (const OffsetKind kind : {OffsetKind::lattice, OffsetKind::r2}) {
        const PermuteConfig config = permute_config(tile, kind);
        const Permuter permuter(tile, textures(tile, kind, 0), config, width, height);
        for (int64_t frame = 0; frame < 12; ++frame) {
            const auto mask_at = [&](int64_t t, int x, int y) {
                const Imath::V2i o = mask_offset(config.offsets, t);
                return tile.values(wrap(x + o.x, 32), wrap(y + o.y, 16));
            };
            Array2D<uint32_t> seeds(width, height);
            double before = 0, after = 0;
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x) {
                    seeds(x, y) = mask_at(frame, x, y);
                    before +=
                        std::abs(double(mask_at(frame, x, y)) - double(mask_at(frame + 1, x, y)));
                }
            const Array2D<uint32_t> moved = permuter.retargeted(seeds, frame, {}, Workers(1));
            for (int y = 0; y < height; ++y)
                for (int x = 0; x < width; ++x)
                    after += std::abs(double(moved(x, y)) - double(mask_at(frame + 1, x, y)));
            EXPECT_LT(after, 0.1 * before);
        }
    }
}

class Passes : public testing::TestWithParam<std::pair<int, int>> {};

TEST_P(Passes, AreBijectionsOver100Frames) {
    const auto [width, height] = GetParam();
    const Mask tile = mask(16, 16);
    const std::vector<RetargetTexture> set = textures(tile, OffsetKind::lattice, 4);
    for (const ReprojectMode mode :
         {ReprojectMode::off, ReprojectMode::image, ReprojectMode::tile}) {
        PermuteConfig config = permute_config(tile);
        config.reproject = mode;
        config.block_jitter = BlockJitter::on;
        const Permuter permuter(tile, set, config, width, height);
        Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
        EXPECT_EQ(seeds.width() % 16, 0);
        const std::vector<uint32_t> all = sorted(seeds);
        for (int frame = 0; frame < 100; ++frame) {
            const Array2D<float> intensity = noise(width, height, uint32_t(frame));
            const MotionPlanes motion = swirl(width, height, frame);
            FrameGuides guides{&intensity, &motion, {}};
            const Array2D<uint32_t> next = permuter.next_seeds(seeds, frame, guides, Workers(2));
            ASSERT_EQ(sorted(next), all) << "frame " << frame;
            EXPECT_NE(next, seeds);
            seeds = next;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Permute, Passes,
                         testing::Values(std::pair{1, 1}, std::pair{1, 7}, std::pair{61, 67}));

// Seeds 0, 1, 2, ...: each must be there once.
bool holds_each_once(const Array2D<uint32_t>& seeds) {
    std::vector<bool> seen(seeds.size());
    for (const uint32_t seed : seeds.values()) {
        if (seed >= seen.size() || seen[seed]) return false;
        seen[seed] = true;
    }
    return true;
}

class FullHd : public testing::TestWithParam<ReprojectMode> {};

TEST_P(FullHd, PassesAreBijectionsOver100Frames) {
    const Mask tile = mask(64, 64);
    PermuteConfig config = permute_config(tile);
    config.reproject = GetParam();
    const Permuter permuter(tile, textures(tile, OffsetKind::lattice, 1), config, 1920, 1080);
    EXPECT_EQ(permuter.padded_height(), 1088);
    std::vector<Array2D<float>> intensities;
    std::vector<MotionPlanes> motions;
    for (int i = 0; i < 3; ++i) {
        intensities.push_back(noise(1920, 1080, uint32_t(i)));
        motions.push_back(swirl(1920, 1080, i));
    }
    Array2D<uint32_t> seeds(permuter.padded_width(), permuter.padded_height());
    std::iota(seeds.values().begin(), seeds.values().end(), 0u);
    for (int frame = 0; frame < 100; ++frame) {
        const FrameGuides guides{&intensities[size_t(frame % 3)], &motions[size_t(frame % 3)], {}};
        seeds = permuter.next_seeds(std::move(seeds), frame, guides, Workers(2));
        ASSERT_TRUE(holds_each_once(seeds)) << "frame " << frame;
    }
}

INSTANTIATE_TEST_SUITE_P(Permute, FullHd,
                         testing::Values(ReprojectMode::off, ReprojectMode::image,
                                         ReprojectMode::tile));

TEST(Permute, DoesNotDependOnTheNumberOfThreads) {
    const Mask tile = mask(16, 16);
    PermuteConfig config = permute_config(tile);
    config.reproject = ReprojectMode::tile;
    const Permuter permuter(tile, textures(tile, OffsetKind::lattice, 2), config, 100, 70);
    const Array2D<float> intensity = noise(100, 70, 1);
    const MotionPlanes motion = swirl(100, 70, 3);
    const FrameGuides guides{&intensity, &motion, {}};
    const Array2D<uint32_t> seeds = permuter.fresh_seeds(5);
    EXPECT_EQ(permuter.next_seeds(seeds, 5, guides, Workers(1)),
              permuter.next_seeds(seeds, 5, guides, Workers(4)));
}

TEST(Permute, RefreshesEveryKFrames) {
    const Mask tile = mask(8, 8);
    PermuteConfig config = permute_config(tile);
    config.refresh_frames = 3;
    const Permuter permuter(tile, {}, config, 20, 20);
    const Array2D<float> intensity = noise(20, 20, 1);
    const Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    for (int frame = 0; frame < 9; ++frame) {
        const Array2D<uint32_t> next =
            permuter.next_seeds(seeds, frame, {&intensity, nullptr, {}}, Workers(1));
        EXPECT_EQ(next == permuter.fresh_seeds(frame + 1), (frame + 1) % 3 == 0);
    }
}

TEST(Permute, PadsWithFreshSeedsAndGivesBackWhatIsSeen) {
    const Mask tile = mask(8, 8);
    const Permuter permuter(tile, {}, permute_config(tile), 10, 3);
    const Array2D<uint32_t> seeds = words(10, 3, 4);
    const Array2D<uint32_t> padded = permuter.padded_seeds(seeds, 7);
    EXPECT_EQ(padded.width(), 16);
    EXPECT_EQ(padded.height(), 8);
    EXPECT_EQ(permuter.visible_seeds(padded), seeds);
    EXPECT_EQ(padded(12, 5), permuter.fresh_seeds(7)(12, 5));
    EXPECT_EQ(permuter.padded_seeds(padded, 7), padded);
    EXPECT_THROW(permuter.padded_seeds(words(9, 3, 4), 7), Error);
}

TEST(Permute, RefusesTexturesThatDoNotFit) {
    const Mask tile = mask(8, 8);
    const PermuteConfig lattice = permute_config(tile);
    std::vector<RetargetTexture> set = textures(tile, OffsetKind::lattice, 0);
    EXPECT_NO_THROW(Permuter(tile, set, lattice, 9, 9));
    EXPECT_THROW(Permuter(tile, set, permute_config(tile, OffsetKind::r2), 9, 9), Error);
    EXPECT_THROW(Permuter(mask(8, 16), set, permute_config(mask(8, 16)), 9, 9), Error);
    set[0].mask_hash = "other";
    EXPECT_THROW(Permuter(tile, set, lattice, 9, 9), Error);
    PermuteConfig reproject = lattice;
    reproject.reproject = ReprojectMode::image;
    EXPECT_THROW(Permuter(tile, {}, reproject, 9, 9), Error);
}

// The example of bn-permute(1): a 4 x 4 mask with step (1, 0), one block.
TEST(Permute, TheExampleOfTheManualPageHolds) {
    const Array2D<uint32_t> bayer(4, 4, {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5});
    // Intensities 0..15 in reading order; seeds 100..115 with them.
    Array2D<float> intensity(4, 4);
    Array2D<uint32_t> seeds(4, 4);
    for (uint32_t i = 0; i < 16; ++i) {
        intensity[i] = float(i);
        seeds[i] = 100 + i;
    }
    SortConfig config;
    config.block_px = 4;
    config.mask_offset = {1, 0}; // frame 1
    sort_seeds(seeds, intensity, bayer, {}, config, Workers(1));
    EXPECT_EQ(seeds, Array2D<uint32_t>(4, 4,
                                       {108, 102, 110, 100, 104, 114, 106, 112, 111, 101, 109, 103,
                                        107, 113, 105, 115}));
    // The mask moves on by -1: the texture that fits without error is (-1, 0) everywhere.
    const Array2D<Imath::V2i> moves(4, 4, {-1, 0});
    seeds = retargeted_seeds(seeds, moves, {1, 0}, Workers(1));
    EXPECT_EQ(seeds, Array2D<uint32_t>(4, 4,
                                       {102, 110, 100, 108, 114, 106, 112, 104, 101, 109, 103, 111,
                                        113, 105, 115, 107}));
    const Array2D<uint32_t> before = seeds;
    config.mask_offset = {2, 0}; // frame 2: seeds are in place already
    Array2D<float> same(4, 4);
    for (size_t i = 0; i < 16; ++i)
        same[i] = float(seeds[i]);
    sort_seeds(seeds, same, bayer, {}, config, Workers(1));
    EXPECT_EQ(seeds, before);
}

} // namespace
} // namespace ql
