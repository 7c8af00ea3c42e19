// The sample numbers of a pass, the same for all pixels, and how each pixel shifts them.
//
// Base sets are additive recurrences on generalised golden ratios (Roberts 2018; in one dimension
// the spiral of Vogel 1979) from a start that depends on seed and pass alone. A pixel shifts them
// modulo 1 (Cranley & Patterson 1976): not at all, which keeps the image coherent and shows bands;
// by white noise; or by a blue-noise mask, which leaves an error without low frequencies (Georgiev
// & Fajardo, "Blue-noise dithered sampling", 2016). Over passes and seeds every estimate stays
// unbiased, because the starts are random.
#pragma once

#include "base/array2d.h"
#include "sampling/random.h"
#include "sampling/warp.h"

#include <vector>

namespace ql {

enum class Rotation { none, white, blue };

// The pattern, one array for each value: (xi1, xi2), and xi1 times sine and cosine of 2 pi xi2.
struct PatternPoints {
    std::vector<float> xi1, xi2, x, y;
    float sum_of_squares = 0; // of all xi1

    size_t size() const { return xi1.size(); }
    bool operator==(const PatternPoints&) const = default;
};

// Numbers in [0, 1).
struct SampleNumbers {
    double pick;    // chooses a row of texels, or a map
    float xi1, xi2; // xi1 chooses the texel of a row; both: a point of the disc
    SinCos angle;   // of 2 pi xi2
};

struct PassSamples {
    PatternPoints pattern;
    std::vector<SampleNumbers> flux;   // importance: half the samples, rounded up
    std::vector<SampleNumbers> around; // importance: the rest
};

// samples: at least 1. The pattern is stratified in xi1. Neighbours in these sets find neighbouring
// texels as a rule, which memory and packets of rays like.
PassSamples pattern_samples(int samples, uint64_t seed, uint32_t pass);
PassSamples importance_samples(int samples, uint64_t seed, uint32_t pass);

// What a pixel adds to pick, xi1 and xi2. mask: thresholds in [0, 1), needed for blue.
struct ShiftSource {
    Rotation rotation = Rotation::none;
    const Array2D<float>* mask = nullptr;
    uint64_t seed = 0;

    std::array<float, 3> shift(int x, int y, uint32_t pass) const;
};

// Sine and cosine of the sum of two angles.
inline SinCos turned(const SinCos& a, const SinCos& b) {
    return {a.sin * b.cos + a.cos * b.sin, a.cos * b.cos - a.sin * b.sin};
}

inline float shifted(float number, float shift) {
    const float sum = number + shift;
    return sum < 1 ? sum : sum - 1;
}
inline double shifted(double number, float shift) {
    const double sum = number + double(shift);
    return sum < 1 ? sum : sum - 1;
}

} // namespace ql
