// All passes between two frames, in order: from the frame's image and seeds to the next frame's
// seeds.
//
//     seeds of frame t  ->  render t  ->  sort against M_t  ->  [pick textures by motion]
//                       ->  retarget t to t + 1  ->  [refresh]  ->  seeds of frame t + 1
//
// Heitz and Belcour 2019, section 4; Heinle 2020, chapter 3. A permutation of the padded seed
// texture but for the refresh; results are functions of the arguments alone, for any number of
// threads. Thread safe: const.
#pragma once

#include "base/parallel.h"
#include "bluenoise/mask_file.h"
#include "bluenoise/offsets.h"
#include "bluenoise/reproject.h"
#include "bluenoise/retarget_file.h"
#include "image/image.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace ql {

enum class BlockJitter { off, on };
enum class ReprojectMode { off, image, tile };

struct PermuteConfig {
    int block_px = 8;                            // side of the sorted blocks, [1, 64]; 1: no sort
    BlockJitter block_jitter = BlockJitter::off; // another lattice of blocks in each frame
    MaskOffsets offsets;                         // of the mask's tile
    ReprojectMode reproject = ReprojectMode::off;
    int refresh_frames = 0; // K: fresh seeds for the frames K, 2K, ...; 0: never
    uint64_t seed = 0;      // of fresh seeds and of the jitter
};

// The offsets of a kind for this mask; `lattice` takes the step of the textures if they have one in
// common, so that sets made with another step go too.
MaskOffsets permute_offsets(OffsetKind kind, const Mask& mask,
                            const std::vector<RetargetTexture>& textures);

// What the passes look at besides seeds; planes of the image's size.
struct FrameGuides {
    const Array2D<float>* intensity = nullptr; // of the frame alone, not accumulated; finite
    const MotionPlanes* motion = nullptr;      // to the next frame; needed to reproject
    Array2D<uint32_t> surfaces;                // empty, or like surfaces alike: surface_numbers()
};

class Permuter {
  public:
    // No textures: no retargeting. Errors: ErrorKind::input if a texture was made for another mask
    // or if one that is needed (its step, motion (0, 0)) is missing; ErrorKind::usage for the
    // config.
    Permuter(const Mask& mask, std::vector<RetargetTexture> textures, const PermuteConfig& config,
             int width, int height);

    // Of the seed texture: whole tiles.
    int padded_width() const { return m_padded_width; }
    int padded_height() const { return m_padded_height; }

    // Seeds for a frame that starts afresh, as bn-render makes them, on the padded texture.
    Array2D<uint32_t> fresh_seeds(int64_t frame) const;
    // Seeds of the image's size, with fresh ones beyond it. Errors: ErrorKind::input for other
    // sizes.
    Array2D<uint32_t> padded_seeds(const Array2D<uint32_t>& seeds, int64_t frame) const;
    // The part of the padded texture that a frame is rendered with.
    Array2D<uint32_t> visible_seeds(const Array2D<uint32_t>& padded) const;

    // The passes one by one. seeds: padded.
    void sort(Array2D<uint32_t>& seeds, int64_t frame, const FrameGuides& guides,
              const Workers& workers) const;
    Array2D<uint32_t> retargeted(const Array2D<uint32_t>& seeds, int64_t frame,
                                 const FrameGuides& guides, const Workers& workers) const;

    // All of them: the padded seeds of frame + 1.
    Array2D<uint32_t> next_seeds(Array2D<uint32_t> seeds, int64_t frame, const FrameGuides& guides,
                                 const Workers& workers) const;

    // o(t) of the mask in this frame, in [0, N); it jumps where seeds are refreshed.
    Imath::V2i offset(int64_t frame) const;

    // The motion that the image as a whole is taken to have; (0, 0) without reprojection.
    Imath::V2i image_motion(const FrameGuides& guides) const;

  private:
    const RetargetTexture& texture(int64_t frame, const Imath::V2i& motion) const;

    PermuteConfig m_config;
    int m_width, m_height, m_padded_width, m_padded_height;
    Array2D<uint32_t> m_ranks;
    std::vector<RetargetTexture> m_textures;
    int m_motion_limit = 0;
};

// The luminance of R, G, B, or the only plane. Errors: ErrorKind::input.
Array2D<float> intensity_plane(const Image& image, const std::string& path);

// The same over the luminance of albedo.R .G .B: what a texture adds to the intensity says nothing
// about the pixel's random numbers, so dividing by it leaves the error to be sorted. Where the
// albedo is below 1e-4 or not finite (nothing hit, emitters) the intensity stays. Errors:
// ErrorKind::input.
Array2D<float> demodulated(const Array2D<float>& intensity, const Image& guides,
                           const std::string& path);

// Motion planes motion.X, motion.Y, if there; not finite where Z, or else id, says that nothing was
// hit.
std::optional<MotionPlanes> motion_planes(const Image& image);

// A number for each pixel, equal where surfaces are alike: object "id" (unsigned) if there, the
// normal N.X N.Y N.Z in steps of 1/4, albedo.R .G .B in steps of 1/8. Empty if there is none of
// them.
Array2D<uint32_t> surface_numbers(const Image& guides);

} // namespace ql
