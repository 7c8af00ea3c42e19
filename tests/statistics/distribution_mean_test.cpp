// However random numbers are given to pixels, the mean of a frame stays: tiles of frame 5 over
// independent sequences have the mean that white noise has (Welch's test, Sidak over the tiles).
#include "bluenoise/retarget_solve.h"
#include "distribution/frame_sequence.h"
#include "metrics/statistics.h"
#include "reference/scene_builder.h"
#include "sampling/seeds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

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

// Where the camera goes: nowhere, or to the right by about a pixel a frame.
enum class Camera { still, moving };

TileMeans last_frames(SequenceConfig config, Camera move, uint64_t first_seed) {
    const Scene scene = cornell(lambert(V3f(0.6f)), emitter(V3f(12)));
    const Workers workers;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    std::vector<PixelCamera> cameras;
    for (int frame = 0; frame <= kLastFrame + 1; ++frame) {
        View view = cornell_view(kSide);
        if (move == Camera::moving) view.from.x = view.at.x = 0.03 * (frame - kLastFrame);
        cameras.push_back(camera_of(view, scene, space));
    }
    const Mask mask = small_mask();
    std::vector<RetargetTexture> textures;
    RetargetConfig moves;
    moves.radius_px = 3;
    for (const RetargetConfig& problem : retarget_set({lattice_step(16, 16)}, 2, moves))
        textures.push_back(exact_retarget_texture(mask, problem));
    config.permute.offsets = mask_offsets(OffsetKind::lattice, 16, 16);
    // Only temporal frames follow from those before them.
    const int first = config.distribution == Distribution::temporal ? 0 : kLastFrame;
    TileMeans tiles;
    Progress progress;
    for (uint64_t seed = first_seed; seed < first_seed + kSequences; ++seed) {
        config.seed = seed;
        FrameSequence sequence(config, mask, textures, kSide, kSide);
        for (int frame = first; frame <= kLastFrame; ++frame) {
            const NextFrame next{cameras[size_t(frame) + 1], world_from_nodes(scene, 0)};
            const FrameResult result =
                sequence.render({posed, cameras[size_t(frame)], next, frame}, workers, progress);
            if (frame == kLastFrame) add_tiles(result.image, tiles);
            sequence.prepare_next(workers);
        }
    }
    return tiles;
}

SequenceConfig of(Distribution distribution) {
    SequenceConfig config;
    config.distribution = distribution;
    return config;
}

double least_p(const TileMeans& a, const TileMeans& b) {
    double least = 1;
    for (size_t i = 0; i < a.size(); ++i)
        least = std::min(least, welch_test(sample_moments(a[i]), sample_moments(b[i])).p_value);
    return least;
}

// The camera is at the same place in the last frame.
const TileMeans& white() {
    static const TileMeans means = last_frames(of(Distribution::white), Camera::still, 1000);
    return means;
}

const size_t kTests = 5 * (kSide / kTile) * (kSide / kTile);

void expect_the_mean_of_white(const SequenceConfig& config, Camera move) {
    EXPECT_GT(least_p(last_frames(config, move, 1), white()), sidak_level(kLevel, kTests));
}

TEST(DistributionMean, OfTemporalIsWhiteNoises) {
    expect_the_mean_of_white(of(Distribution::temporal), Camera::still);
}

TEST(DistributionMean, OfTemporalIsWhiteNoisesBehindAMovingCamera) {
    SequenceConfig config = of(Distribution::temporal);
    config.permute.reproject = ReprojectMode::tile;
    config.similar = SimilarSurfaces::on;
    expect_the_mean_of_white(config, Camera::moving);
}

TEST(DistributionMean, OfDitheredIsWhiteNoises) {
    expect_the_mean_of_white(of(Distribution::dithered), Camera::still);
}

TEST(DistributionMean, OfHistogramIsWhiteNoises) {
    expect_the_mean_of_white(of(Distribution::histogram), Camera::still);
}

// The mean square error, over the pixels, of the mean over 256 frames. A mask of 4 x 4 comes back
// every fourth frame.
double error_over_frames(Distribution distribution) {
    constexpr int kFrames = 256, kPixels = 16;
    const Scene scene = cornell(lambert(V3f(0.6f)), emitter(V3f(12)));
    const Workers workers;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    const PixelCamera camera = camera_of(cornell_view(kPixels), scene, space);
    const NextFrame next{camera, world_from_nodes(scene, 0)};
    MaskConfig tile;
    tile.method = MaskMethod::bayer;
    tile.width = tile.height = 4;
    Progress progress;
    Mask mask{mask_ranks(tile, progress), 16, ""};
    mask.hash = mask_hash(mask.values);
    SequenceConfig config = of(distribution);
    config.render.path.max_depth = 1;
    config.permute.offsets = mask_offsets(OffsetKind::lattice, 4, 4);
    std::vector<double> sums(kPixels * kPixels, 0);
    FrameSequence sequence(config, mask, {}, kPixels, kPixels);
    for (int frame = 0; frame < kFrames; ++frame) {
        const Image image = sequence.render({posed, camera, next, frame}, workers, progress).image;
        for (size_t i = 0; i < sums.size(); ++i)
            sums[i] += double((*image.find("G"))[i]) / kFrames;
    }
    RenderConfig many = config.render;
    many.spp = 4096;
    const Image exact = render_frame(posed, camera, fresh_seeds(77, 0, kPixels, kPixels), many,
                                     nullptr, workers, progress)
                            .image;
    double error = 0;
    for (size_t i = 0; i < sums.size(); ++i)
        error += std::pow(sums[i] - double((*exact.find("G"))[i]), 2);
    return error / double(sums.size());
}

TEST(DistributionMean, OfHistogramOverFramesNearsTheTruthInEachPixel) {
    EXPECT_LT(error_over_frames(Distribution::histogram),
              1.6 * error_over_frames(Distribution::white));
}

TEST(DistributionMean, IsKnownWellEnoughToSeeATenth) {
    TileMeans brighter = last_frames(of(Distribution::white), Camera::still, 1);
    for (std::vector<double>& tile : brighter)
        for (double& mean : tile)
            mean *= 1.1;
    EXPECT_LT(least_p(brighter, white()), sidak_level(kLevel, kTests));
}

} // namespace
} // namespace ql
