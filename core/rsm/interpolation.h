// Irradiance of a pixel from the four grid pixels around it, where they lie on the same surface.
//
// Screen-space interpolation of Dachsbacher & Stamminger 2005, section 4. A grid pixel agrees if
// its normal is within about 8 degrees and the point lies in its plane up to a twentieth of the
// distance between the two. Pure function.
#pragma once

#include "rsm/gather.h"

#include <optional>

namespace ql {

struct GridIrradiance {
    bool valid = false; // something was hit there
    Receiver receiver;
    V3f irradiance = {0, 0, 0};
};

// corners: upper left, upper right, lower left, lower right; s, t in [0, 1): the pixel's place
// between them. None: gather anew.
std::optional<V3f> interpolated_irradiance(const Receiver& receiver,
                                           const GridIrradiance* const corners[4], float s,
                                           float t);

} // namespace ql
