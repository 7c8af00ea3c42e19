#include "sampling/random.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <vector>

namespace ql {
namespace {

// tests/kat_vectors of the Random123 library, the lines "philox4x32 7" and "philox4x32 10".
TEST(Philox, GivesTheKnownAnswersOfItsAuthors) {
    constexpr uint32_t kOnes = 0xffffffff;
    const RandomWords pi = {0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344};
    EXPECT_EQ(philox4x32<10>({0, 0, 0, 0}, {0, 0}),
              (RandomWords{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}));
    EXPECT_EQ(philox4x32<10>({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
              (RandomWords{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}));
    EXPECT_EQ(philox4x32<10>(pi, {0xa4093822, 0x299f31d0}),
              (RandomWords{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}));
    EXPECT_EQ(philox4x32<7>({kOnes, kOnes, kOnes, kOnes}, {kOnes, kOnes}),
              (RandomWords{0x5207ddc2, 0x45165e59, 0x4d8ee751, 0x8c52f662}));
    EXPECT_EQ(philox4x32<7>(pi, {0xa4093822, 0x299f31d0}),
              (RandomWords{0x4dfccaba, 0x190a87f0, 0xc47362ba, 0xb6b5242a}));
}

TEST(UnitFloat, IsNeverOne) {
    EXPECT_EQ(unit_float(0), 0.0f);
    EXPECT_EQ(unit_float(0xffffffff), 1.0f - 0x1p-24f);
    EXPECT_LT(unit_double(0xffffffff, 0xffffffff), 1.0);
    EXPECT_EQ(unit_double(0x80000000, 0), 0.5);
}

TEST(PixelRandom, FollowsFromSeedSampleAndDimensionAlone) {
    const PixelRandom random(17, 3);
    EXPECT_EQ(random.block(2), PixelRandom(17, 3).block(2));
    EXPECT_NE(random.block(2), random.block(3));
    EXPECT_NE(random.block(2), PixelRandom(17, 4).block(2));
    EXPECT_NE(random.block(2), PixelRandom(18, 3).block(2));
    // Sample and dimension must not be exchangeable.
    EXPECT_NE(PixelRandom(17, 2).block(3), random.block(2));
}

TEST(CounterRandom, DrawsTheSameSequenceByBlockAndOneByOne) {
    const CounterRandom by_block(0x123456789abcdef0, uint64_t{1} << 40);
    CounterRandom one_by_one(0x123456789abcdef0, uint64_t{1} << 40);
    for (uint32_t block = 0; block < 3; ++block)
        for (const uint32_t word : by_block.words(block))
            EXPECT_EQ(one_by_one.next_word(), word);
    one_by_one.next_float();
    EXPECT_EQ(one_by_one.next_block(), by_block.block(4));
}

TEST(CounterRandom, UsesAll64BitsOfKeyAndIndex) {
    std::set<RandomWords> seen;
    for (int bit = 0; bit < 64; ++bit) {
        seen.insert(CounterRandom(uint64_t{1} << bit, 0).words(0));
        seen.insert(CounterRandom(0, uint64_t{1} << bit).words(0));
    }
    EXPECT_EQ(seen.size(), 128u);
}

// Flipping any bit of the input flips each bit of the output half of the time.
TEST(Hash32, HasAvalanche) {
    constexpr int kTrials = 2000;
    for (int bit = 0; bit < 160; ++bit) {
        std::array<int, 32> flips{};
        for (uint32_t trial = 0; trial < kTrials; ++trial) {
            const uint64_t seed = trial * uint64_t{0x9E3779B97F4A7C15};
            const uint32_t x = trial % 61, y = trial / 61, frame = trial % 7;
            uint32_t difference = hash32(seed, x, y, frame);
            if (bit < 64)
                difference ^= hash32(seed ^ uint64_t{1} << bit, x, y, frame);
            else if (bit < 96)
                difference ^= hash32(seed, x ^ 1u << (bit - 64), y, frame);
            else if (bit < 128)
                difference ^= hash32(seed, x, y ^ 1u << (bit - 96), frame);
            else
                difference ^= hash32(seed, x, y, frame ^ 1u << (bit - 128));
            for (size_t i = 0; i < 32; ++i)
                flips[i] += static_cast<int>(difference >> i & 1);
        }
        // 5120 counts of standard deviation 22.4: six of them never happen by chance.
        for (const int count : flips)
            EXPECT_NEAR(count, kTrials / 2, 6 * std::sqrt(kTrials / 4.0)) << "input bit " << bit;
    }
}

TEST(Hash32, GivesNeighbouringPixelsDifferentSeeds) {
    std::set<uint32_t> seeds;
    for (uint32_t y = 0; y < 100; ++y)
        for (uint32_t x = 0; x < 100; ++x)
            seeds.insert(hash32(0, x, y, 0));
    EXPECT_GE(seeds.size(), 9999u); // birthday: 0.01 collisions expected
}

TEST(Bounded, IsUniformWhereTheRemainderWouldBeBiased) {
    // With n = 3 * 2^30 the modulus would give the lower 2^30 values twice the probability.
    CounterRandom random(7);
    constexpr uint32_t kBound = 3u << 30;
    std::array<int, 3> thirds{};
    constexpr int kDraws = 30000;
    for (int i = 0; i < kDraws; ++i) {
        const uint32_t value = bounded(random, kBound);
        ASSERT_LT(value, kBound);
        ++thirds[value >> 30];
    }
    for (const int count : thirds)
        EXPECT_NEAR(count, kDraws / 3, 5 * std::sqrt(kDraws * 2 / 9.0));
    EXPECT_EQ(bounded(random, 1), 0u);
}

TEST(Shuffle, ReachesEveryOrderEquallyOften) {
    std::map<std::vector<int>, int> counts;
    constexpr int kShuffles = 24000;
    for (uint64_t i = 0; i < kShuffles; ++i) {
        CounterRandom random(3, i);
        std::vector<int> values(4);
        std::iota(values.begin(), values.end(), 0);
        shuffle(std::span(values), random);
        ++counts[values];
    }
    EXPECT_EQ(counts.size(), 24u);
    for (const auto& [order, count] : counts)
        EXPECT_NEAR(count, 1000, 5 * std::sqrt(1000.0));
}

TEST(Shuffle, KeepsEveryValueOfAPrimeLength) {
    std::vector<uint32_t> values(997);
    std::iota(values.begin(), values.end(), 0u);
    CounterRandom random(1);
    shuffle(std::span(values), random);
    EXPECT_EQ(std::set<uint32_t>(values.begin(), values.end()).size(), 997u);
}

} // namespace
} // namespace ql
