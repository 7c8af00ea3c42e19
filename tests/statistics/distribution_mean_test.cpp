// However random numbers are given to pixels, the mean of a frame stays: tiles of frame 5 over
// independent sequences have the mean that white noise has (Welch's test, Sidak over the tiles).
#include "bluenoise/retarget_solve.h"
#include "distribution/frame_sequence.h"
#include "metrics/statistics.h"
#include "reference/scene_builder.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ql {
namespace {

using namespace reference;

constexpr int kSide = 64;
constexpr int kTile = 16;
constexpr int kSequences = 24;
constexpr int kLastFrame = 5;
constexpr double kLevel = 0.01;

using TileMeans = std::vector<std::vector<double>>; // by tile, one value per sequence

Mask small_mask() {
    MaskConfig config;
    config.width = config.height = 16;
    config.sigma_px = 1.2;
    Progress progress;
    Mask mask{mask_ranks(config, progress), 16 * 16, ""};
    mask.hash = mask_hash(mask.values);
    return mask;
}

void add_tiles(const Image& image, TileMeans& tiles) {
    const int across = kSide / kTile;
    tiles.resize(size_t(across * across));
    for (size_t tile = 0; tile < tiles.size(); ++tile) {
        double sum = 0;
        for (int y = 0; y < kTile; ++y)
            for (int x = 0; x < kTile; ++x)
                for (const char* channel : {"R", "G", "B"})
                    sum += double((*image.find(channel))(int(tile) % across * kTile + x,
                                                         int(tile) / across * kTile + y));
        tiles[tile].push_back(sum / (3 * kTile * kTile));
    }
}

TileMeans last_frames(Distribution distribution, uint64_t first_seed) {
    const Scene scene = cornell(lambert(V3f(0.6f)), emitter(V3f(12)));
    const Workers workers;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    const PixelCamera camera = camera_of(cornell_view(kSide), scene, space);
    const NextFrame next{camera, {}};
    const Mask mask = small_mask();
    RetargetConfig moves;
    moves.step = lattice_step(16, 16);
    const RetargetTexture texture = exact_retarget_texture(mask, moves);
    SequenceConfig config;
    config.distribution = distribution;
    config.permute.offsets = mask_offsets(OffsetKind::lattice, 16, 16);
    TileMeans tiles;
    Progress progress;
    for (uint64_t seed = first_seed; seed < first_seed + kSequences; ++seed) {
        config.seed = seed;
        FrameSequence sequence(config, mask, {texture}, kSide, kSide);
        for (int frame = 0; frame <= kLastFrame; ++frame) {
            const FrameResult result =
                sequence.render({posed, camera, next, frame}, workers, progress);
            if (frame == kLastFrame) add_tiles(result.image, tiles);
            sequence.prepare_next(workers);
        }
    }
    return tiles;
}

double least_p(const TileMeans& a, const TileMeans& b) {
    double least = 1;
    for (size_t i = 0; i < a.size(); ++i)
        least = std::min(least, welch_test(sample_moments(a[i]), sample_moments(b[i])).p_value);
    return least;
}

const TileMeans& white() {
    static const TileMeans means = last_frames(Distribution::white, 1000);
    return means;
}

const size_t kTests = 3 * (kSide / kTile) * (kSide / kTile);

TEST(DistributionMean, OfTemporalIsWhiteNoises) {
    EXPECT_GT(least_p(last_frames(Distribution::temporal, 1), white()),
              sidak_level(kLevel, kTests));
}

TEST(DistributionMean, OfDitheredIsWhiteNoises) {
    EXPECT_GT(least_p(last_frames(Distribution::dithered, 1), white()),
              sidak_level(kLevel, kTests));
}

TEST(DistributionMean, IsKnownWellEnoughToSeeATenth) {
    TileMeans brighter = last_frames(Distribution::white, 1);
    for (std::vector<double>& tile : brighter)
        for (double& mean : tile)
            mean *= 1.1;
    EXPECT_LT(least_p(brighter, white()), sidak_level(kLevel, kTests));
}

} // namespace
} // namespace ql
