// From a mask to its retarget textures, with figures and bound filled in. Pure functions; textures
// are independent of each other and may be solved in parallel.
#pragma once

#include "bluenoise/anneal.h"
#include "bluenoise/retarget_file.h"

#include <vector>

namespace ql {

// The problems of all steps with all motions of up to `motions` pixels on each axis, steps
// outermost, then rows; radius and penalty as in `base`.
std::vector<RetargetConfig> retarget_set(const std::vector<Imath::V2i>& steps, int motions,
                                         const RetargetConfig& base);

// The optimum; its cost equals its bound, which is checked.
RetargetTexture exact_retarget_texture(const Mask& mask, const RetargetConfig& config);

struct AnnealedTexture {
    RetargetTexture texture;
    AnnealResult run; // its moves are in the texture
};
enum class BoundMode { exact, none };
// bound none: energy_bound stays zero, which is true as well.
AnnealedTexture annealed_retarget_texture(const Mask& mask, const RetargetConfig& config,
                                          const AnnealConfig& schedule, BoundMode bound,
                                          Progress& progress);

// The mask's tile as it looks when its pixels have moved, as thresholds in [0, 1].
Array2D<float> moved_tile(const RetargetProblem& problem, const Moves& moves);

} // namespace ql
