#include "rsm/samples.h"

#include "base/check.h"

#include <cmath>

namespace ql {

namespace {

constexpr uint64_t kSampleKey = 0x52534d736d706c00;
constexpr float kBelowOne = 0x1.fffffep-1f;

// Steps of the additive recurrences in one and three dimensions: 1/g^i, where g is the positive
// root of g^(d + 1) = g + 1. http://extremelearning.com.au/unreasonable-effectiveness-of-
// quasirandom-sequences/
constexpr double kGolden = 0.6180339887498949;
constexpr double kStep3[3] = {0.8191725133961645, 0.6710436067037893, 0.5497004779019703};
// In two dimensions, for where a mask is read in each of its uses.
constexpr double kStep2[2] = {0.7548776662466927, 0.5698402909980532};

double fraction(double x) {
    return x - std::floor(x);
}

float float_fraction(double x) {
    return std::min(float(fraction(x)), kBelowOne);
}

std::vector<SampleNumbers> recurrence(int count, const CounterRandom& random, uint32_t block) {
    const RandomFloats start = random.block(block);
    std::vector<SampleNumbers> numbers;
    numbers.reserve(size_t(count));
    for (int i = 0; i < count; ++i)
        numbers.push_back({fraction(double(start[0]) + i * kStep3[0]),
                           float_fraction(double(start[1]) + i * kStep3[1]),
                           float_fraction(double(start[2]) + i * kStep3[2])});
    return numbers;
}

} // namespace

PassSamples pattern_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const RandomFloats start = CounterRandom(seed ^ kSampleKey, pass).block(0);
    PassSamples result;
    for (int i = 0; i < samples; ++i)
        result.pattern.emplace_back(std::min(float((i + double(start[0])) / samples), kBelowOne),
                                    float_fraction(double(start[1]) + i * kGolden));
    return result;
}

PassSamples importance_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const CounterRandom random(seed ^ kSampleKey, pass);
    PassSamples result;
    result.flux = recurrence((samples + 1) / 2, random, 1);
    result.around = recurrence(samples / 2, random, 2);
    return result;
}

std::array<float, 3> ShiftSource::shift(int x, int y, uint32_t pass) const {
    if (rotation == Rotation::none) return {0, 0, 0};
    if (rotation == Rotation::white) {
        const RandomFloats u =
            PixelRandom(hash32(seed, uint32_t(x), uint32_t(y), pass), 0).block(0);
        return {u[0], u[1], u[2]};
    }
    std::array<float, 3> result{};
    for (int i = 0; i < 3; ++i) {
        // Each number reads the mask elsewhere; each pass moves all of it by the golden ratio.
        const int dx = int(fraction(i * kStep2[0]) * mask->width());
        const int dy = int(fraction(i * kStep2[1]) * mask->height());
        const float value = (*mask)((x + dx) % mask->width(), (y + dy) % mask->height());
        result[size_t(i)] = float_fraction(double(value) + pass * kGolden);
    }
    return result;
}

} // namespace ql
