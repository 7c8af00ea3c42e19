// Retarget textures as images.
//
// A texture R holds, for each pixel i of the mask's tile, where the seed that stands there goes:
// to i + R(i), toroidally. EXR: channels dx and dy in pixels, one part for each texture. PNG, 8
// bit: R = dx + 128, G = dy + 128, B = 0. Both say in ql:* what they are made for, as text: mask
// (hash), step, motion, radius_px, energy_initial, energy, energy_bound. Pure functions.
#pragma once

#include "bluenoise/retarget_problem.h"
#include "image/image.h"

#include <string>
#include <vector>

namespace ql {

struct RetargetTexture {
    Array2D<Imath::V2i> moves;  // R = m + d, pixels, |component| <= 120
    Imath::V2i step = {0, 0};   // of the mask, in [0, N)
    Imath::V2i motion = {0, 0}; // of the surface
    int radius_px = 0;
    std::string mask_hash;
    RetargetReport report;
    double energy_bound = 0; // nothing can be lower; in steps of the mask
};

enum class RetargetEncoding { exr, png };

Image retarget_image(const RetargetTexture& texture, RetargetEncoding encoding);

// Errors: ErrorKind::input if a part is no retarget texture, or no bijection of its tile.
std::vector<RetargetTexture> retarget_textures(const std::vector<Image>& parts,
                                               const std::string& path);

// "motion_-4_3", or "step_49_37_motion_-4_3" where several steps are in a set.
enum class NamedBy { motion, step_and_motion };
std::string retarget_name(const RetargetTexture& texture, NamedBy named_by);

} // namespace ql
