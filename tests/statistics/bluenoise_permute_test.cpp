// The passes on a flat scene: every pixel's value follows from its seed alone. The energy that a
// Gaussian of 1 px leaves, relative to white noise, at frame 24.
#include "bluenoise/permute.h"
#include "bluenoise/retarget_solve.h"
#include "reference/permute_reference.h"
#include "sampling/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>

namespace ql {
namespace {

using reference::blue_mask;

constexpr int kSide = 256;

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

TEST(BluenoisePermute, WhiteNoiseLeavesOne) {
    Array2D<float> values(kSide, kSide);
    for (uint32_t i = 0; i < values.size(); ++i)
        values[i] = unit_float(hash32(3, i, 0, 0));
    EXPECT_NEAR(energy_left(values), 1, 0.05);
}

TEST(BluenoisePermute, SortAlone) {
    const Mask mask = blue_mask(1.9);
    for (const auto& [block_px, energy] : {std::pair(4, 0.583), {8, 0.240}, {16, 0.114}})
        EXPECT_NEAR(energy_at_frame_24(mask, {}, OffsetKind::lattice, block_px), energy,
                    0.15 * energy)
            << block_px;
}

TEST(BluenoisePermute, SortAndRetarget) {
    for (const auto& [sigma_px, block_px, energy] :
         {std::tuple(1.9, 4, 0.079), {1.9, 8, 0.076}, {1.2, 4, 0.023}, {1.2, 8, 0.019}}) {
        const Mask mask = blue_mask(sigma_px);
        EXPECT_NEAR(energy_at_frame_24(mask, {texture(mask)}, OffsetKind::lattice, block_px),
                    energy, 0.15 * energy)
            << sigma_px << " " << block_px;
    }
}

// One texture does not fit the four steps of the sequence.
TEST(BluenoisePermute, R2NeedsFourTextures) {
    const Mask mask = blue_mask(1.9);
    std::vector<RetargetTexture> four;
    for (const Imath::V2i& step : retarget_steps(mask_offsets(OffsetKind::r2, 64, 64)))
        four.push_back(texture(mask, step));
    const double with_four = energy_at_frame_24(mask, four, OffsetKind::r2, 4);
    const double with_one = energy_at_frame_24(mask, four, OffsetKind::thesis, 4);
    EXPECT_NEAR(with_four, 0.079, 0.15 * 0.079);
    EXPECT_NEAR(with_one, 0.143, 0.15 * 0.143);
}

// Surfaces that differ: cells of 48 x 48 pixels in which bright seeds are bright, and cells in
// which they are dark. All move by `motion` a frame, and the passes are told `told`. Mean of
// frames 8..39.
double energy_of_moving_cells(ReprojectMode mode, const Imath::V2i& motion,
                              const Imath::V2i& told) {
    constexpr int kCell = 48, kFar = 100 * kCell, kFirst = 8, kFrames = 40;
    const Mask mask = blue_mask(1.2);
    std::vector<RetargetTexture> textures;
    for (const Imath::V2i& m : {Imath::V2i(0, 0), told}) {
        RetargetConfig moves;
        moves.step = lattice_step(64, 64);
        moves.motion = m;
        moves.move_penalty = 1; // moves of 2 px: longer ones would hide those of the surfaces
        textures.push_back(exact_retarget_texture(mask, moves));
    }
    PermuteConfig config;
    config.offsets = mask_offsets(OffsetKind::lattice, 64, 64);
    config.reproject = mode;
    const Permuter permuter(mask, std::move(textures), config, kSide, kSide);
    const Workers workers;
    const MotionPlanes planes{Array2D<float>(kSide, kSide, float(told.x)),
                              Array2D<float>(kSide, kSide, float(told.y))};
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    Array2D<float> values(kSide, kSide);
    Array2D<uint32_t> surfaces(kSide, kSide);
    double energy = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
        for (int y = 0; y < kSide; ++y)
            for (int x = 0; x < kSide; ++x) {
                const float u = PixelRandom(seeds(x, y), 0).block(0)[0];
                const int column = (x - frame * motion.x + kFar) / kCell;
                const int row = (y - frame * motion.y + kFar) / kCell;
                surfaces(x, y) = uint32_t(column + row) % 2;
                values(x, y) = surfaces(x, y) == 0 ? u : 1 - u;
            }
        if (frame >= kFirst) energy += energy_left(values) / (kFrames - kFirst);
        seeds = permuter.next_seeds(seeds, frame, {&values, &planes, surfaces}, workers);
    }
    return energy;
}

TEST(BluenoisePermute, FollowingTheMotionHelpsWhereSurfacesDiffer) {
    double off = 0, image = 0, tile = 0, wrong = 0;
    for (const Imath::V2i& motion : {Imath::V2i(4, 4), Imath::V2i(-4, 1), Imath::V2i(2, -3)}) {
        off += energy_of_moving_cells(ReprojectMode::off, motion, motion);
        image += energy_of_moving_cells(ReprojectMode::image, motion, motion);
        tile += energy_of_moving_cells(ReprojectMode::tile, motion, motion);
        wrong += energy_of_moving_cells(ReprojectMode::image, motion, -motion);
    }
    EXPECT_LT(image, 0.95 * off);
    EXPECT_EQ(tile, image); // one motion for all tiles
    EXPECT_LT(image, 0.95 * wrong);
}

// The mean over `frames` frames of a flat scene whose seeds are refreshed: its variance over that
// of as many frames of white noise. The mask must not show a pixel the same values after each
// refresh.
double variance_of_mean(int frames, int refresh_frames, std::vector<RetargetTexture> textures,
                        const Mask& mask) {
    PermuteConfig config;
    config.offsets = mask_offsets(OffsetKind::lattice, 64, 64);
    config.refresh_frames = refresh_frames;
    const Permuter permuter(mask, std::move(textures), config, kSide, kSide);
    const Workers workers;
    Array2D<uint32_t> seeds = permuter.fresh_seeds(0);
    Array2D<float> values(kSide, kSide);
    Array2D<double> sums(kSide, kSide);
    for (int frame = 0; frame < frames; ++frame) {
        for (size_t i = 0; i < seeds.size(); ++i)
            sums[i] += double(values[i] = PixelRandom(seeds[i], 0).block(0)[0]) - 0.5;
        seeds = permuter.next_seeds(seeds, frame, {&values, nullptr, {}}, workers);
    }
    double variance = 0;
    for (const double sum : sums.values())
        variance += sum * sum / double(sums.size());
    return variance / frames * 12;
}

TEST(BluenoisePermute, MeansWithRefreshConvergeLikeWhiteNoise) {
    const Mask mask = blue_mask(1.2);
    const std::vector<RetargetTexture> textures = {texture(mask)};
    for (const int refresh_frames : {8, 16, 64}) {
        EXPECT_LT(variance_of_mean(256, refresh_frames, textures, mask), 1) << refresh_frames;
        EXPECT_LT(variance_of_mean(256, refresh_frames, {}, mask), 2) << refresh_frames;
    }
    EXPECT_GT(variance_of_mean(256, 0, textures, mask), 2);
    EXPECT_GT(variance_of_mean(256, 0, {}, mask), 4);
}

} // namespace
} // namespace ql
