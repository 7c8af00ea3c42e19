#include "rsm/samples.h"

#include "base/check.h"

#include <algorithm>
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

double fraction(double x) {
    return x - std::floor(x);
}

float float_fraction(double x) {
    return std::min(float(fraction(x)), kBelowOne);
}

// The place of a point of the unit square on the Z-shaped curve (Morton 1966) through 256 x 256
// cells.
uint32_t curve_place(double x, double y) {
    const auto column = uint32_t(std::clamp(x, 0.0, 1.0) * 255);
    const auto row = uint32_t(std::clamp(y, 0.0, 1.0) * 255);
    uint32_t place = 0;
    for (int bit = 0; bit < 8; ++bit)
        place |= (column >> bit & 1) << (2 * bit) | (row >> bit & 1) << (2 * bit + 1);
    return place;
}

std::vector<SampleNumbers> recurrence(int count, const CounterRandom& random, uint32_t block) {
    const RandomFloats start = random.block(block);
    std::vector<SampleNumbers> numbers;
    numbers.reserve(size_t(count));
    for (int i = 0; i < count; ++i) {
        const float xi2 = float_fraction(double(start[2]) + i * kStep3[2]);
        numbers.push_back({fraction(double(start[0]) + i * kStep3[0]),
                           float_fraction(double(start[1]) + i * kStep3[1]), xi2,
                           sin_cos_turns(xi2)});
    }
    return numbers;
}

template<class Place>
void sort_along_curve(std::vector<SampleNumbers>& numbers, const Place& place) {
    std::stable_sort(numbers.begin(), numbers.end(),
                     [&](const auto& a, const auto& b) { return place(a) < place(b); });
}

// Of a point at distance xi1 and angle 2 pi xi2 from the middle of a disc.
uint32_t disc_place(float xi1, const SinCos& angle) {
    return curve_place(0.5 + 0.5 * double(xi1 * angle.sin), 0.5 + 0.5 * double(xi1 * angle.cos));
}

} // namespace

PassSamples pattern_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const RandomFloats start = CounterRandom(seed ^ kSampleKey, pass).block(0);
    std::vector<SampleNumbers> numbers;
    for (int i = 0; i < samples; ++i) {
        const float xi1 = std::min(float((i + double(start[0])) / samples), kBelowOne);
        const float xi2 = float_fraction(double(start[1]) + i * kGolden);
        numbers.push_back({0, xi1, xi2, sin_cos_turns(xi2)});
    }
    sort_along_curve(numbers, [](const auto& n) { return disc_place(n.xi1, n.angle); });
    PassSamples result;
    for (const SampleNumbers& n : numbers) {
        result.pattern.xi1.push_back(n.xi1);
        result.pattern.xi2.push_back(n.xi2);
        result.pattern.x.push_back(n.xi1 * n.angle.sin);
        result.pattern.y.push_back(n.xi1 * n.angle.cos);
        result.pattern.sum_of_squares += n.xi1 * n.xi1;
    }
    return result;
}

PassSamples importance_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const CounterRandom random(seed ^ kSampleKey, pass);
    PassSamples result;
    result.flux = recurrence((samples + 1) / 2, random, 1);
    result.around = recurrence(samples / 2, random, 2);
    sort_along_curve(result.flux, [](const auto& n) { return curve_place(n.pick, double(n.xi1)); });
    sort_along_curve(result.around, [](const auto& n) { return disc_place(n.xi1, n.angle); });
    return result;
}

std::array<float, 3> ShiftSource::shift(int x, int y, uint32_t pass) const {
    if (rotation == Rotation::none) return {0, 0, 0};
    if (rotation == Rotation::white) {
        const RandomFloats u =
            PixelRandom(hash32(seed, uint32_t(x), uint32_t(y), pass), 0).block(0);
        return {u[0], u[1], u[2]};
    }
    // One number of the mask moves all three, along a line: the error is then a function of that
    // one number, which is what a scalar mask can make blue. Passes go on by the golden ratio.
    const float value = (*mask)(x % mask->width(), y % mask->height());
    const float t = float_fraction(double(value) + pass * kGolden);
    return {t, t, t};
}

} // namespace ql
