// The passes on a flat scene: every pixel's value follows from its seed alone. The energy that a
// Gaussian of 1 px leaves, relative to white noise, at frame 24.
#include "bluenoise/permute.h"
#include "bluenoise/retarget_solve.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

constexpr int kSide = 256;

Mask blue_mask(double sigma_px) {
    MaskConfig config;
    config.sigma_px = sigma_px;
    Progress progress;
    Mask mask{mask_ranks(config, progress), 64 * 64, ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

RetargetTexture texture(const Mask& mask, const Imath::V2i& step = lattice_step(64, 64)) {
    RetargetConfig config;
    config.step = step;
    return exact_retarget_texture(mask, config);
}

Array2D<double> filtered_transposed(const Array2D<double>& in) {
    constexpr int kRadius = 5;
    double sum_of_weights = 0;
    for (int i = -kRadius; i <= kRadius; ++i)
        sum_of_weights += std::exp(-0.5 * i * i);
    Array2D<double> out(in.height(), in.width());
    for (int y = 0; y < in.height(); ++y)
        for (int x = 0; x < in.width(); ++x) {
            double sum = 0;
            for (int i = -kRadius; i <= kRadius; ++i)
                sum += std::exp(-0.5 * i * i) * in(wrap(x + i, in.width()), y);
            out(y, x) = sum / sum_of_weights;
        }
    return out;
}

// White noise of variance v leaves v / (4 pi) after a Gaussian of 1 px.
double energy_left(const Array2D<float>& values) {
    Array2D<double> error(values.width(), values.height());
    for (size_t i = 0; i < error.size(); ++i)
        error[i] = double(values[i]) - 0.5;
    const Array2D<double> filtered = filtered_transposed(filtered_transposed(error));
    double energy = 0;
    for (const double e : filtered.values())
        energy += e * e / double(error.size());
    return energy / (1.0 / 12 / (4 * M_PI));
}

double energy_at_frame_24(const Mask& mask, std::vector<RetargetTexture> textures,
                          OffsetKind kind = OffsetKind::lattice, int block_px = 8) {
    PermuteConfig config;
    config.block_px = block_px;
    config.offsets = mask_offsets(kind, 64, 64);
    const Permuter permuter(mask, std::move(textures), config, kSide, kSide);
    const Workers workers;
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    Array2D<float> values(kSide, kSide);
    for (int frame = 0;; ++frame) {
        for (size_t i = 0; i < seeds.size(); ++i)
            values[i] = PixelRandom(seeds[i], 0).block(0)[0];
        if (frame == 24) return energy_left(values);
        seeds = permuter.next_seeds(seeds, frame, {&values, nullptr, {}}, workers);
    }
}

TEST(bluenoise_permute, white_noise_leaves_one) {
    Array2D<float> values(kSide, kSide);
    for (uint32_t i = 0; i < values.size(); ++i)
        values[i] = unit_float(hash32(3, i, 0, 0));
    EXPECT_NEAR(energy_left(values), 1, 0.05);
}

TEST(bluenoise_permute, sort_alone) {
    EXPECT_NEAR(energy_at_frame_24(blue_mask(1.9), {}), 0.24, 0.15 * 0.24);
}

TEST(bluenoise_permute, sort_and_retarget_with_sigma_1_9) {
    const Mask mask = blue_mask(1.9);
    EXPECT_NEAR(energy_at_frame_24(mask, {texture(mask)}), 0.076, 0.15 * 0.076);
}

TEST(bluenoise_permute, sort_and_retarget_with_sigma_1_2) {
    const Mask mask = blue_mask(1.2);
    EXPECT_NEAR(energy_at_frame_24(mask, {texture(mask)}), 0.019, 0.15 * 0.019);
}

// One texture does not fit the four steps of the sequence.
TEST(bluenoise_permute, r2_needs_four_textures) {
    const Mask mask = blue_mask(1.9);
    std::vector<RetargetTexture> four;
    for (const Imath::V2i& step : retarget_steps(mask_offsets(OffsetKind::r2, 64, 64)))
        four.push_back(texture(mask, step));
    const double with_four = energy_at_frame_24(mask, four, OffsetKind::r2, 4);
    const double with_one = energy_at_frame_24(mask, four, OffsetKind::thesis, 4);
    EXPECT_NEAR(with_four, 0.079, 0.15 * 0.079);
    EXPECT_NEAR(with_one, 0.143, 0.15 * 0.143);
}

} // namespace
} // namespace ql
