// Frames in sequence, and which pixel gets which random numbers in each of them.
//
//   white      a fresh hash of (seed, pixel, frame) for every pixel
//   dithered   one sequence for all pixels, shifted by the mask (Georgiev and Fajardo 2016)
//   histogram  K estimates of every pixel, and of these the one at the mask's quantile: the limit
//              that the temporal method approaches (Heitz and Belcour 2019, section 3)
//   temporal   the seeds of the frame before, permuted (Heitz and Belcour 2019, section 4)
//
// Results do not depend on the number of threads.
#pragma once

#include "bluenoise/permute.h"
#include "render/path_tracer.h"

#include <optional>

namespace ql {

enum class Distribution { white, dithered, histogram, temporal };
enum class SimilarSurfaces { off, on };
enum class Demodulate { off, on };

struct SequenceConfig {
    Distribution distribution = Distribution::white;
    RenderConfig render;
    uint64_t seed = 0;  // of fresh seeds
    int estimates = 16; // histogram: K, [1, 4096]
    PermuteConfig permute;
    SimilarSurfaces similar = SimilarSurfaces::off; // sort among like surfaces only
    Demodulate demodulate = Demodulate::off;        // sort intensity over albedo
};

// What a frame is rendered from.
struct FrameView {
    const PosedScene& scene;
    const PixelCamera& camera;
    const NextFrame& next;
    int frame;
};

class FrameSequence {
  public:
    // A mask is needed for all but white; textures serve temporal alone.
    // Errors: ErrorKind::usage or input from Permuter.
    FrameSequence(const SequenceConfig& config, const std::optional<Mask>& mask,
                  std::vector<RetargetTexture> textures, int width, int height);

    // Seeds of the next frame to be rendered, of the image's size or padded to whole tiles.
    void set_seeds(const Array2D<uint32_t>& seeds, int frame);

    FrameResult render(const FrameView& view, const Workers& workers, Progress& progress);
    // temporal: permutes the seeds of the frame just rendered for the one that follows it; must be
    // called between two frames. Nothing to do for the others.
    void prepare_next(const Workers& workers);

    // The seeds that the last frame was rendered with; temporal: padded to whole tiles.
    const Array2D<uint32_t>& seeds() const { return m_seeds; }

  private:
    FrameResult render_with(const FrameView& view, const Array2D<uint32_t>& seeds,
                            const RenderConfig& config, const Workers& workers,
                            Progress& progress) const;
    Array2D<uint32_t> quantile_seeds(const FrameView& view, const Workers& workers,
                                     Progress& progress, FrameResult& spent) const;
    FrameResult render_temporal(const FrameView& view, const Workers& workers, Progress& progress);
    DitherTile dither_tile(int frame) const;

    SequenceConfig m_config;
    int m_width, m_height;
    std::optional<Permuter> m_permuter;
    Array2D<uint32_t> m_ranks;      // of the mask; dithered and histogram
    Array2D<uint32_t> m_seeds;      // of the last frame
    Array2D<uint32_t> m_next_seeds; // of the next one, if known

    // What the passes will look at in the last frame; temporal.
    struct Guides {
        int frame = 0;
        Array2D<float> intensity;
        std::optional<MotionPlanes> motion;
        Array2D<uint32_t> surfaces;
    };
    std::optional<Guides> m_guides;
};

} // namespace ql
