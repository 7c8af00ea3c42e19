// How the mask moves from frame to frame: M_t(x) = M((x + o(t)) mod N), o(0) = 0.
//
// All kinds follow the R2 sequence (M. Roberts 2018, "The unreasonable effectiveness of
// quasirandom sequences": 1/g and 1/g^2 with the plastic number g).
//   lattice  the constant step coprime with the tile that is next to R2's: one retarget texture
//   r2       o(t) = floor(t N / g): steps of two lengths an axis, so four retarget textures
//   thesis   the offsets of r2 with the one texture for the shorter steps (Heinle 2020), which
//            fits little more than a third of the frames
// Pixels, toroidal. Pure functions.
#pragma once

#include <Imath/ImathVec.h>

#include <cstdint>
#include <vector>

namespace ql {

enum class OffsetKind { lattice, r2, thesis };

struct MaskOffsets {
    OffsetKind kind = OffsetKind::lattice;
    int width = 1; // of the mask
    int height = 1;
    Imath::V2i step = {0, 0}; // lattice only
};

// The step that `lattice` takes on a tile of this size, in [0, N).
Imath::V2i lattice_step(int width, int height);
MaskOffsets mask_offsets(OffsetKind kind, int width, int height);

// o(frame), in [0, N). frame >= 0.
Imath::V2i mask_offset(const MaskOffsets& offsets, int64_t frame);

// Where seeds are fresh the mask may jump, and it must: `lattice` shows a pixel the same N values
// of the mask again and again, so that the mean over many frames would keep their error. The sum of
// `count` jumps, each of the same step along y, which takes all places before it comes back.
Imath::V2i mask_jumps(const MaskOffsets& offsets, int64_t count);

// The step of the retarget texture that takes seeds from this frame to the next.
Imath::V2i retarget_step(const MaskOffsets& offsets, int64_t frame);

// The steps of all retarget textures that are needed.
std::vector<Imath::V2i> retarget_steps(const MaskOffsets& offsets);

} // namespace ql
