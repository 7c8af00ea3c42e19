// A colour scale for pictures of figures: black, blue, magenta, orange, yellow, white, rising in
// lightness all the way so that it also reads in grey. Green is for what is not finite.
#pragma once

#include "image/image.h"

#include <Imath/ImathVec.h>

namespace ql {

// t in [0, 1], clamped. Linear Rec. 709 R, G, B in [0, 1]; NaN gives pure green.
Imath::V3f false_color(float t);

// R, G, B of the values on a logarithmic scale from black at `low` to white at `high`,
// 0 < low < high.
Image heat_picture(const Array2D<float>& values, double low, double high);

} // namespace ql
