// Counter-based random numbers: every number is a pure function of a key and a counter, so results
// do not depend on the order or the number of threads.
//
// Source: Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011
// (Philox4x32). Seven rounds pass BigCrush (table 2 there); ten are the authors' safe choice.
// Floats are multiples of 2^-24 in [0, 1): never 1. Everything here is a value without shared
// state.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

namespace ql {

using RandomWords = std::array<uint32_t, 4>;
using RandomFloats = std::array<float, 4>;

inline constexpr int kPhiloxRounds = 7;

template<int Rounds = kPhiloxRounds>
constexpr RandomWords philox4x32(RandomWords counter, std::array<uint32_t, 2> key) {
    for (int round = 0; round < Rounds; ++round) {
        const uint64_t a = uint64_t{0xD2511F53} * counter[0];
        const uint64_t b = uint64_t{0xCD9E8D57} * counter[2];
        counter = {static_cast<uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<uint32_t>(b),
                   static_cast<uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<uint32_t>(a)};
        key[0] += 0x9E3779B9; // golden ratio
        key[1] += 0xBB67AE85; // sqrt(3) - 1
    }
    return counter;
}

// The upper 24 bits as a float in [0, 1 - 2^-24].
constexpr float unit_float(uint32_t word) {
    return static_cast<float>(word >> 8) * 0x1p-24f;
}

// 53 bits of two words as a double in [0, 1 - 2^-53].
constexpr double unit_double(uint32_t high, uint32_t low) {
    return static_cast<double>((uint64_t{high} << 32 | low) >> 11) * 0x1p-53;
}

constexpr RandomFloats unit_floats(const RandomWords& words) {
    return {unit_float(words[0]), unit_float(words[1]), unit_float(words[2]), unit_float(words[3])};
}

// Keeps the users of Philox apart where their keys coincide: the last word of the counter.
enum class RandomDomain : uint32_t { pixel = 0, counter = 1, seed_texture = 2 };

// The random numbers of one sample of a pixel. They follow from the 32-bit seed of the pixel and
// the sample alone, never from the position of the pixel.
class PixelRandom {
  public:
    constexpr PixelRandom(uint32_t seed, uint32_t sample) : m_seed(seed), m_sample(sample) {}

    // Four numbers: dimensions 4 b to 4 b + 3 of block b.
    constexpr RandomFloats block(uint32_t dimension_block) const {
        return unit_floats(words(dimension_block));
    }
    constexpr RandomWords words(uint32_t dimension_block) const {
        return philox4x32(
            {m_sample, dimension_block, 0, static_cast<uint32_t>(RandomDomain::pixel)},
            {m_seed, 0});
    }

  private:
    uint32_t m_seed;
    uint32_t m_sample;
};

// Random numbers of item `index` (a photon, a mask, a shuffle) under a 64-bit key. By number of the
// block, or one after the other; both draw from the same sequence.
class CounterRandom {
  public:
    explicit constexpr CounterRandom(uint64_t key, uint64_t index = 0)
        : m_key(key), m_index(index) {}

    constexpr RandomFloats block(uint32_t number) const { return unit_floats(words(number)); }
    constexpr RandomWords words(uint32_t number) const {
        return philox4x32({static_cast<uint32_t>(m_index), static_cast<uint32_t>(m_index >> 32),
                           number, static_cast<uint32_t>(RandomDomain::counter)},
                          {static_cast<uint32_t>(m_key), static_cast<uint32_t>(m_key >> 32)});
    }

    constexpr uint32_t next_word() {
        if (m_used == 4) {
            m_words = words(m_next_block++);
            m_used = 0;
        }
        return m_words[m_used++];
    }
    constexpr float next_float() { return unit_float(next_word()); }
    // The next whole block; words left over from the last one are skipped.
    constexpr RandomFloats next_block() {
        m_used = 4;
        return block(m_next_block++);
    }

  private:
    uint64_t m_key;
    uint64_t m_index;
    RandomWords m_words{};
    uint32_t m_next_block = 0;
    uint32_t m_used = 4;
};

// A 32-bit seed for pixel (x, y) of a frame; independent of every other in practice.
constexpr uint32_t hash32(uint64_t seed, uint32_t x, uint32_t y, uint32_t frame) {
    return philox4x32({x, y, frame, static_cast<uint32_t>(RandomDomain::seed_texture)},
                      {static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32)})[0];
}

// An integer in [0, n), n > 0, without bias: Lemire, "Fast random integer generation in an
// interval", ACM TOMACS 29 (2019), algorithm 5.
constexpr uint32_t bounded(CounterRandom& random, uint32_t n) {
    uint64_t product = uint64_t{random.next_word()} * n;
    if (static_cast<uint32_t>(product) < n) {
        const uint32_t threshold = (0u - n) % n;
        while (static_cast<uint32_t>(product) < threshold)
            product = uint64_t{random.next_word()} * n;
    }
    return static_cast<uint32_t>(product >> 32);
}

// Fisher-Yates; the same order on every platform. At most 2^32 - 1 values.
template<class T>
constexpr void shuffle(std::span<T> values, CounterRandom& random) {
    for (size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[bounded(random, static_cast<uint32_t>(i))]);
}

} // namespace ql
