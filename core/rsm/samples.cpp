#include "rsm/samples.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr uint64_t kSampleKey = 0x52534d736d706c00;
constexpr float kBelowOne = 0x1.fffffep-1f;

// Masks go on by the golden ratio from pass to pass.
constexpr double kGolden = 0.6180339887498949;

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

struct LatticePoint {
    double u;
    float v;
    SinCos angle; // of 2 pi v
};

std::vector<LatticePoint> lattice_points(int count, const Lattice& lattice, double u0, double v0) {
    std::vector<LatticePoint> points;
    points.reserve(size_t(count));
    for (int64_t i = 0; i < count; ++i) {
        const float v = float_fraction(v0 + double(i * lattice.step % count) / count);
        points.push_back({fraction((double(i) + u0) / count), v, sin_cos_turns(v)});
    }
    return points;
}

template<class Place>
void sort_along_curve(std::vector<LatticePoint>& points, const Place& place) {
    std::stable_sort(points.begin(), points.end(),
                     [&](const auto& a, const auto& b) { return place(a) < place(b); });
}

FluxPoints flux_points(int count, const RandomFloats& start) {
    const Lattice lattice = rank1_lattice(count);
    auto points = lattice_points(count, lattice, double(start[0]), double(start[1]));
    sort_along_curve(points, [](const auto& p) { return curve_place(p.u, double(p.v)); });
    FluxPoints result;
    result.cell = lattice.cell;
    for (const LatticePoint& p : points) {
        result.u.push_back(p.u);
        result.v.push_back(p.v);
    }
    return result;
}

DiscPoints disc_points(int count, const RandomFloats& start) {
    DiscPoints result;
    if (count == 0) return result;
    const Lattice lattice = rank1_lattice(count);
    auto points = lattice_points(count, lattice, double(start[0]), double(start[1]));
    sort_along_curve(points, [](const auto& p) {
        return curve_place(0.5 + 0.5 * p.u * double(p.angle.sin),
                           0.5 + 0.5 * p.u * double(p.angle.cos));
    });
    result.cell = lattice.cell;
    result.start = double(start[0]);
    for (const LatticePoint& p : points) {
        result.xi1.push_back(std::min(float(p.u), kBelowOne));
        result.sine.push_back(p.angle.sin);
        result.cosine.push_back(p.angle.cos);
    }
    return result;
}

} // namespace

float DiscPoints::sum_of_squares(float shift) const {
    // The distances are (i + o) / n, i from 0, for the start o.
    const auto n = double(size());
    const double o = fraction(start + double(shift) * n);
    return float(((n - 1) * (2 * n - 1) / 6 + o * (n - 1) + o * o) / n);
}

PassSamples pattern_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const CounterRandom random(seed ^ kSampleKey, pass);
    return {{}, disc_points(samples, random.block(0))};
}

PassSamples importance_samples(int samples, uint64_t seed, uint32_t pass) {
    QL_CHECK(samples >= 1);
    const CounterRandom random(seed ^ kSampleKey, pass);
    return {flux_points((samples + 1) / 2, random.block(1)),
            disc_points(samples / 2, random.block(2))};
}

CellPlace ShiftSource::place(int x, int y, uint32_t pass) const {
    if (rotation == Rotation::none) return {};
    if (rotation == Rotation::white) {
        const RandomFloats u =
            PixelRandom(hash32(seed, uint32_t(x), uint32_t(y), pass), 0).block(0);
        return {.first = u[0], .second = u[1]};
    }
    const float value = (*mask)(x % mask->width(), y % mask->height());
    return {.along = float_fraction(double(value) + pass * kGolden)};
}

} // namespace ql
