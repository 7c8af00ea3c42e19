// Separable low-pass filters, the same along both axes.
//
// Taps are normalised to sum 1; tap k weighs the pixel k - taps / 2 to the right (or below), so
// that an even number of taps moves the picture by half a pixel. Sums are taken in double in a
// fixed order, so that results do not depend on the number of threads.
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <span>
#include <vector>

namespace ql {

// What stands beyond the border: the picture mirrored (edge pixels twice), or its other side.
enum class Border { mirror, wrap };

// exp(-x^2 / (2 sigma^2)) at whole pixels, cut off at 4 sigma. sigma_px = 0 is the identity.
std::vector<double> gaussian_taps(double sigma_px);
// `size` equal taps; size is odd.
std::vector<double> box_taps(int size);
// Row `order` of Pascal's triangle, over 2^order: order + 1 taps.
std::vector<double> binomial_taps(int order);

Array2D<float> filtered(const Array2D<float>& image, std::span<const double> taps, Border border,
                        const Workers& workers);

} // namespace ql
