// Figures of threshold masks, which are tileable images whose values are all used equally often.
//
// Values are replaced by ranks first, u = (smaller ones + half the equal ones) / pixels, so that 8
// bit, 16 bit and float masks are alike.
#pragma once

#include "base/array2d.h"
#include "base/parallel.h"

#include <span>
#include <string>
#include <vector>

namespace ql {

// u of each pixel, in (0, 1).
Array2D<float> rank_values(const Array2D<float>& mask);

// How far the low-pass filtered pattern of 1[u < t] is from t: the root of the mean square over
// pixels and over t = 0/128 .. 127/128, the mask tiled without end. Donnelly et al. 2024 ("Filter-
// adapted spatio-temporal sampling"). `taps` are those of a separable filter.
double heaviside_rms(const Array2D<float>& ranks, std::span<const double> taps,
                     const Workers& workers);

struct NamedRms {
    std::string filter;
    double rms = 0;
};
// For the filters of that paper: Gaussians of 1 and 0.7 px, binomials of order 2 and 3, boxes of 3
// and 5 px.
std::vector<NamedRms> heaviside_table(const Array2D<float>& ranks, const Workers& workers);

struct ValueCounts {
    size_t distinct = 0; // different values
    size_t fewest = 0;   // how often the rarest and the commonest of them occur
    size_t most = 0;
    // Largest distance between the share of values below x and x (Kolmogorov's statistic), for
    // values that should be uniform in [0, 1].
    double uniformity_error = 0;
};
ValueCounts value_counts(const Array2D<float>& mask);

// Mean step across the seam against mean step between neighbours elsewhere, in standard errors.
// Steps are absolute differences. Within some 4 of 0 for a tileable mask.
struct SeamTest {
    double horizontal = 0; // from the last column to the first
    double vertical = 0;   // from the last row to the first
};
SeamTest seam_test(const Array2D<float>& mask);

} // namespace ql
