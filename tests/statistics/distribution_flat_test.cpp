// A flat scene, rendered: every pixel sees the same, so that its value follows from its seed alone.
// What a Gaussian of 1 px leaves of the error of frame 24, relative to white noise, is then that of
// the passes without a renderer (bluenoise_permute_test.cpp). The lamp is a strip over which the
// light on the floor falls nearly evenly, so that values are nearly uniform.
#include "bluenoise/retarget_solve.h"
#include "distribution/frame_sequence.h"
#include "metrics/spectrum.h"
#include "reference/permute_reference.h"
#include "reference/scene_builder.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

using namespace reference;

constexpr int kSide = 256;

// A few millimetres of a floor below a strip lamp at a height of 1 m.
Scene flat_scene() {
    SceneBuilder builder;
    const int white = builder.add_material(lambert(V3f(0.7f)));
    const int lamp = builder.add_material(emitter(V3f(10)));
    builder.add_quad({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, white);
    builder.add_quad({0.3f, 1, -0.02f}, {0.3f, 0, 0}, {0, 0, 0.04f}, lamp);
    return builder.scene;
}

double energy_at_frame_24(SequenceConfig config, double sigma_px, bool retarget) {
    const Scene scene = flat_scene();
    const Workers workers;
    const RenderSpace space = render_space_of(scene, workers);
    const PosedScene posed(scene, space, 0, workers);
    const PixelCamera camera =
        camera_of({{-0.3, 0.4, 0.1}, {0, 0, 0}, 0.3, kSide, kSide}, scene, space);
    const NextFrame next{camera, {}};
    const Mask mask = blue_mask(sigma_px);
    std::vector<RetargetTexture> textures;
    if (retarget) {
        RetargetConfig moves;
        moves.step = lattice_step(64, 64);
        textures.push_back(exact_retarget_texture(mask, moves));
    }
    config.render.path.max_depth = 1;
    config.render.path.light_sampling = LightSampling::lights;
    config.permute.offsets = mask_offsets(OffsetKind::lattice, 64, 64);
    FrameSequence sequence(config, mask, textures, kSide, kSide);
    Progress progress;
    const int first = config.distribution == Distribution::temporal ? 0 : 24;
    for (int frame = first;; ++frame) {
        const FrameResult result = sequence.render({posed, camera, next, frame}, workers, progress);
        if (frame == 24) {
            const std::vector<Array2D<float>> frames = {intensity_plane(result.image, "frame")};
            return filtered_variance(mean_spectrum(frames, Window::none, workers), 1).to_white;
        }
        sequence.prepare_next(workers);
    }
}

SequenceConfig of(Distribution distribution, int block_px = 8) {
    SequenceConfig config;
    config.distribution = distribution;
    config.permute.block_px = block_px;
    return config;
}

TEST(DistributionFlat, WhiteNoiseLeavesOne) {
    EXPECT_NEAR(energy_at_frame_24(of(Distribution::white), 1.9, false), 1, 0.05);
}

TEST(DistributionFlat, SortAlone) {
    for (const auto& [block_px, energy] : {std::pair(4, 0.583), {8, 0.240}, {16, 0.114}})
        EXPECT_NEAR(energy_at_frame_24(of(Distribution::temporal, block_px), 1.9, false), energy,
                    0.15 * energy)
            << block_px;
}

TEST(DistributionFlat, SortAndRetarget) {
    for (const auto& [sigma_px, block_px, energy] :
         {std::tuple(1.9, 4, 0.079), {1.9, 8, 0.076}, {1.2, 4, 0.023}, {1.2, 8, 0.019}})
        EXPECT_NEAR(energy_at_frame_24(of(Distribution::temporal, block_px), sigma_px, true),
                    energy, 0.15 * energy)
            << sigma_px << " " << block_px;
}

} // namespace
} // namespace ql
