#include "bluenoise/mask.h"

#include "bluenoise/void_and_cluster.h"
#include "sampling/random.h"

#include <algorithm>
#include <bit>
#include <numeric>

namespace ql {

namespace {

std::vector<uint32_t> random_permutation(size_t n, uint64_t seed, uint64_t channel) {
    std::vector<uint32_t> order(n);
    std::iota(order.begin(), order.end(), 0u);
    CounterRandom random(seed, channel);
    shuffle(std::span(order), random);
    return order;
}

// Bit i of x and y (from the lowest) gives the highest bits of the rank: (x ^ y), then y. Where
// one side is longer, its further bits follow alone.
uint32_t bayer_rank(uint32_t x, uint32_t y, int bits_x, int bits_y) {
    uint32_t rank = 0;
    for (int i = 0; i < std::max(bits_x, bits_y); ++i) {
        const uint32_t bx = x >> i & 1, by = y >> i & 1;
        if (i < bits_x && i < bits_y)
            rank = rank << 2 | (bx ^ by) << 1 | by;
        else
            rank = rank << 1 | bx | by;
    }
    return rank;
}

Array2D<uint32_t> bayer_ranks(int width, int height) {
    const int bits_x = std::countr_zero(uint32_t(width));
    const int bits_y = std::countr_zero(uint32_t(height));
    Array2D<uint32_t> ranks(width, height);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            ranks(x, y) = bayer_rank(uint32_t(x), uint32_t(y), bits_x, bits_y);
    return ranks;
}

} // namespace

void check_mask_config(const MaskConfig& config) {
    if (config.width < 1 || config.height < 1 ||
        size_t(config.width) * size_t(config.height) > kMaxMaskPixels)
        throw usage_error("a mask of {} x {} pixels, expected 1 to {} pixels", config.width,
                          config.height, kMaxMaskPixels);
    const bool powers_of_two =
        std::has_single_bit(uint32_t(config.width)) && std::has_single_bit(uint32_t(config.height));
    if (config.method == MaskMethod::bayer && !powers_of_two)
        throw usage_error("a Bayer mask of {} x {} pixels, expected powers of two", config.width,
                          config.height);
    if (!(config.sigma_px >= 0.3 && config.sigma_px <= 8))
        throw usage_error("a sigma of {} pixels, expected 0.3 to 8", config.sigma_px);
}

size_t mask_memory_bytes(const MaskConfig& config) {
    const size_t n = size_t(config.width) * size_t(config.height);
    // Two fields of 64-bit keys with their trees (1/64 of the pixels, two trees of two nodes),
    // two orders and the ranks; elsewhere the order alone.
    return config.method == MaskMethod::void_and_cluster ? n * (2 * 8 + 2 * 1 + 3 * 4) : n * 4;
}

Array2D<uint32_t> mask_ranks(const MaskConfig& config, Progress& progress) {
    check_mask_config(config);
    if (config.method == MaskMethod::bayer) return bayer_ranks(config.width, config.height);
    const size_t n = size_t(config.width) * size_t(config.height);
    std::vector<uint32_t> order = random_permutation(n, config.seed, config.channel);
    if (config.method == MaskMethod::white) return {config.width, config.height, std::move(order)};
    return void_and_cluster(config.width, config.height, config.sigma_px, order, progress);
}

} // namespace ql
