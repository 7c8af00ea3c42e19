#include "base/error.h"
#include "linespace/accumulate.h"
#include "linespace/cache_file.h"
#include "linespace/groups.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>

namespace ql {
namespace {

CacheHeader small_header() {
    CacheHeader header;
    header.patches = 2;
    header.voxels = {3, 2, 2};
    header.max_depth = 3;
    header.unit = 2.5;
    header.photons = {{0, 10}};
    header.weight_by_order = {5, 7};
    header.caustic_by_order = {0, 2};
    return header;
}

std::vector<Deposit> random_deposits(size_t count, uint64_t seed) {
    CounterRandom random(seed);
    std::vector<Deposit> deposits(count);
    for (Deposit& d : deposits) {
        d.voxel = bounded(random, 12);
        d.shaft = bounded(random, 2 * directed_shaft_count(2));
        for (float& w : d.weight)
            w = 3 * random.next_float();
    }
    return deposits;
}

// Groups of all shafts, with measures of their own.
void add_groups(LightCache& cache) {
    const ShaftGroups groups(cache.header.patches, cache.header.normal_classes);
    cache.group_first.assign(1, 0);
    for (size_t v = 0; v < cache.header.voxel_count(); ++v) {
        for (const uint32_t group : groups.holding(cache.gated_shafts_of(v))) {
            cache.groups.push_back(group);
            cache.group_measures.push_back(2 + float(group));
        }
        cache.group_first.push_back(cache.groups.size());
    }
}

LightCache cache_of(const std::vector<std::vector<Deposit>>& rounds, size_t chunk,
                    const Workers& workers) {
    LightCache cache;
    cache.header = small_header();
    ShaftAccumulator sums(cache.header.voxel_count(), cache.header.sum_bits);
    for (const auto& round : rounds) {
        std::vector<std::vector<Deposit>> chunks;
        for (size_t i = 0; i < round.size(); i += chunk)
            chunks.emplace_back(round.begin() + int64_t(i),
                                round.begin() + int64_t(std::min(round.size(), i + chunk)));
        sums.add(chunks, workers);
    }
    sums.move_to(cache, workers);
    cache.measures.assign(cache.size(), 0.5f);
    add_groups(cache);
    return cache;
}

bool equal(const LightCache& a, const LightCache& b) {
    return a.header == b.header && a.first == b.first && a.shafts == b.shafts &&
           a.counts == b.counts && a.sums == b.sums && a.measures == b.measures &&
           a.group_first == b.group_first && a.groups == b.groups &&
           a.group_measures == b.group_measures;
}

void expect_equal(const LightCache& a, const LightCache& b) {
    EXPECT_EQ(a.header, b.header);
    EXPECT_EQ(a.first, b.first);
    EXPECT_EQ(a.shafts, b.shafts);
    EXPECT_EQ(a.counts, b.counts);
    EXPECT_EQ(a.sums, b.sums);
    EXPECT_EQ(a.measures, b.measures);
    EXPECT_EQ(a.group_first, b.group_first);
    EXPECT_EQ(a.groups, b.groups);
    EXPECT_EQ(a.group_measures, b.group_measures);
}

TEST(ShaftAccumulator, AddsUpLikeAMapWhateverTheRoundsAndThreads) {
    const auto deposits = random_deposits(20000, 1);
    std::map<std::pair<uint32_t, uint32_t>, std::pair<uint32_t, ShaftSum>> expected;
    for (const Deposit& d : deposits) {
        auto& [count, sum] = expected[{d.voxel, d.shaft}];
        ++count;
        for (size_t c = 0; c < 3; ++c)
            sum[c] += std::llrint(double(d.weight[c]) * 0x1p24);
    }
    const std::vector<Deposit> first(deposits.begin(), deposits.begin() + 7000);
    const std::vector<Deposit> rest(deposits.begin() + 7000, deposits.end());
    const LightCache whole = cache_of({deposits}, 100, Workers(1));
    expect_equal(whole, cache_of({rest, first}, 333, Workers(3)));
    ASSERT_EQ(whole.size(), expected.size());
    size_t i = 0;
    for (const auto& [key, value] : expected) {
        EXPECT_GE(i, whole.first[key.first]);
        EXPECT_LT(i, whole.first[key.first + 1]);
        EXPECT_EQ(whole.shafts[i], key.second);
        EXPECT_EQ(whole.counts[i], value.first);
        EXPECT_EQ(whole.sums[i], value.second);
        ++i;
    }
    EXPECT_LE(double(whole.memory_bytes() - whole.first.size() * 8) / double(whole.size()), 40);
}

TEST(ShaftAccumulator, ABillionPhotonsInOneShaftKeepTheirSum) {
    // 10^7 one after the other, then a hundred of those caches.
    const float weight = 1.2345678f;
    const Workers workers(2);
    LightCache part;
    part.header = small_header();
    part.header.photons = {{0, 10000000}};
    ShaftAccumulator sums(part.header.voxel_count(), part.header.sum_bits);
    std::vector<std::vector<Deposit>> chunks;
    for (int round = 0; round < 10; ++round) {
        chunks.assign(10, std::vector<Deposit>(100000, {3, 17, {weight, 1, 0x1p-24f}}));
        sums.add(chunks, workers);
    }
    sums.move_to(part, workers);
    LightCache total = part;
    for (uint64_t i = 1; i < 100; ++i) {
        part.header.photons = {{i * 10000000, (i + 1) * 10000000}};
        total = merged(total, part, "part");
    }
    ASSERT_EQ(total.size(), 1u);
    EXPECT_EQ(total.counts[0], 1000000000u);
    EXPECT_EQ(total.sums[0][0], int64_t(1000000000) * std::llrint(double(weight) * 0x1p24));
    EXPECT_EQ(total.sums[0][1], int64_t(1000000000) << 24);
    EXPECT_EQ(total.sums[0][2], 1000000000);
    EXPECT_EQ(total.header.photons, (std::vector<PhotonRange>{{0, 1000000000}}));
}

TEST(LightCache, MergesInAnyOrderToTheWhole) {
    const Workers workers(2);
    std::vector<std::vector<Deposit>> parts;
    std::vector<LightCache> caches;
    for (uint64_t i = 0; i < 3; ++i) {
        parts.push_back(random_deposits(3000, i));
        caches.push_back(cache_of({parts.back()}, 500, workers));
        caches.back().header.photons = {{i * 10, i * 10 + 10}};
    }
    LightCache whole = cache_of(parts, 500, workers);
    whole.header.photons = {{0, 30}};
    whole.header.weight_by_order = {15, 21};
    whole.header.caustic_by_order = {0, 6};
    const auto merge3 = [&](size_t a, size_t b, size_t c) {
        return merged(merged(caches[a], caches[b], "b"), caches[c], "c");
    };
    expect_equal(whole, merge3(0, 1, 2));
    expect_equal(whole, merge3(2, 0, 1));
    EXPECT_THROW(merged(caches[0], caches[0], "twice"), Error);
}

TEST(LightCache, RefusesSumsThatDoNotFit) {
    LightCache a = cache_of({{{0, 0, {1, 1, 1}}}}, 1, Workers(1));
    LightCache b = a;
    b.header.photons = {{10, 20}};
    a.sums[0][1] = std::numeric_limits<int64_t>::max() - 5;
    EXPECT_THROW(merged(a, b, "b"), Error);
    a.sums[0][1] = 0;
    a.counts[0] = std::numeric_limits<uint32_t>::max();
    EXPECT_THROW(merged(a, b, "b"), Error);
    a.counts[0] = 1;
    b.measures[0] = 0.25f;
    EXPECT_THROW(merged(a, b, "b"), Error);
}

class CacheFile : public testing::Test {
  protected:
    std::string path =
        testing::TempDir() + "/linespace_cache_test_" + std::to_string(getpid()) + ".exr";
    void TearDown() override { std::filesystem::remove(path); }
};

TEST_F(CacheFile, ReadsBackWhatWasWritten) {
    LightCache cache = cache_of({random_deposits(4000, 9)}, 500, Workers(1));
    cache.header.lower = {-1.25, 3e-7, 1e9};
    cache.header.cell = {0.1, 0.2, 0.3};
    cache.header.seed = 0xfedcba9876543210;
    cache.header.scene_hash = 0x0123456789abcdef;
    cache.header.photons = {{0, 7}, {9, 1000000000000}};
    cache.header.unclassified = 12;
    cache.sums[5] = {int64_t(1) << 61, 0, (int64_t(1) << 32) - 1};
    cache.measures[3] = 1e-30f;
    write_cache(path, cache);
    expect_equal(cache, read_cache(path));
}

TEST_F(CacheFile, RefusesGroupsThatAreNotThoseOfTheShafts) {
    LightCache cache = cache_of({random_deposits(300, 2)}, 500, Workers(1));
    cache.groups[2] += 1; // still in order
    write_cache(path, cache);
    EXPECT_THROW(read_cache(path), Error);
    cache = cache_of({random_deposits(300, 2)}, 500, Workers(1));
    cache.group_measures[1] = 0;
    write_cache(path, cache);
    EXPECT_THROW(read_cache(path), Error);
}

TEST_F(CacheFile, RefusesFlippedBitsAndShorterFiles) {
    const LightCache cache = cache_of({random_deposits(300, 2)}, 500, Workers(1));
    write_cache(path, cache);
    std::ifstream in(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    const auto refused = [&](const std::string& damaged) {
        std::ofstream(path, std::ios::binary) << damaged;
        try {
            const LightCache read = read_cache(path);
            // Bits that carry nothing (name of the writer, line order) may change.
            return equal(read, cache);
        } catch (const Error& e) {
            return e.kind() == ErrorKind::input &&
                   std::string(e.what()).find('\n') == std::string::npos;
        }
    };
    CounterRandom random(4);
    for (int i = 0; i < 150; ++i) {
        std::string damaged = bytes;
        damaged[bounded(random, uint32_t(bytes.size()))] ^= char(1 << bounded(random, 8));
        EXPECT_TRUE(refused(damaged)) << i;
    }
    for (int i = 0; i < 40; ++i)
        EXPECT_TRUE(refused(bytes.substr(0, bounded(random, uint32_t(bytes.size()))))) << i;
}

TEST(ShaftAccumulator, RefusesSumsThatLeave64Bits) {
    const Workers workers(2);
    ShaftAccumulator sums(12, 52);
    std::vector<std::vector<Deposit>> chunks(1, std::vector<Deposit>(1, {3, 17, {1024, 1, 1}}));
    sums.add(chunks, workers);
    chunks.assign(1, std::vector<Deposit>(1, {3, 17, {1024, 1, 1}}));
    EXPECT_THROW(sums.add(chunks, workers), Error);
}

} // namespace
} // namespace ql
