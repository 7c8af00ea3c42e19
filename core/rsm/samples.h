// The sample points of a pass, the same for all pixels, and how each pixel shifts them.
//
// Sets are rank-1 lattices (see lattice.h) from a start that depends on seed and pass alone. A
// pixel shifts them within a cell: not at all, which keeps the image coherent and shows bands; by
// white noise; or by blue noise (Georgiev & Fajardo, "Blue-noise dithered sampling", 2016), whose
// colour the error keeps because it is a smooth function of the place in the cell. Over passes and
// seeds every estimate is unbiased, because the starts are random.
#pragma once

#include "base/array2d.h"
#include "rsm/lattice.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <vector>

namespace ql {

enum class Rotation { none, white, blue };

// Points (u, v) of the unit square, one array for each value.
struct FluxPoints {
    std::vector<double> u; // chooses a row of texels
    std::vector<float> v;  // chooses the texel of the row
    LatticeCell cell;

    size_t size() const { return u.size(); }
};

// Points of a disc: distances xi1 from its middle in [0, 1), and angles 2 pi xi2.
struct DiscPoints {
    std::vector<float> xi1, sine, cosine;
    LatticeCell cell;
    double start = 0; // xi1 is (i + start) / n in some order

    size_t size() const { return xi1.size(); }
    // Of all xi1, shifted modulo 1.
    float sum_of_squares(float shift) const;
};

struct PassSamples {
    FluxPoints flux; // importance: half the samples, rounded up
    DiscPoints disc; // importance: the rest; pattern: all
};

// samples: at least 1. Neighbours in these sets find neighbouring texels as a rule, which memory
// and packets of rays like.
PassSamples pattern_samples(int samples, uint64_t seed, uint32_t pass);
PassSamples importance_samples(int samples, uint64_t seed, uint32_t pass);

// A pixel's place in the cells of all lattices. mask: thresholds in [0, 1), needed for blue.
struct ShiftSource {
    Rotation rotation = Rotation::none;
    const Array2D<float>* mask = nullptr;
    uint64_t seed = 0;

    CellPlace place(int x, int y, uint32_t pass) const;
};

inline float shifted(float number, float shift) {
    const float sum = number + shift;
    return sum < 1 ? sum : sum - 1;
}
inline double shifted(double number, float shift) {
    const double sum = number + double(shift);
    return sum < 1 ? sum : sum - 1;
}

} // namespace ql
