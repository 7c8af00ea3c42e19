#include "rsm/lattice.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace ql {

namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;
constexpr double kGolden = 0.6180339887498949;

struct IntVector {
    int64_t x, y;

    int64_t dot(const IntVector& o) const { return x * o.x + y * o.y; }
};

struct IntCell {
    IntVector a, b;
};

// The shortest two vectors of a lattice (Lagrange 1773, Gauss 1801).
IntCell reduced(IntCell cell) {
    auto& [a, b] = cell;
    if (a.dot(a) > b.dot(b)) std::swap(a, b);
    while (true) {
        const auto times = int64_t(std::llround(double(a.dot(b)) / double(a.dot(a))));
        const IntVector rest{b.x - times * a.x, b.y - times * a.y};
        if (rest.dot(rest) >= a.dot(a)) {
            b = rest;
            return cell;
        }
        b = a;
        a = rest;
    }
}

// What a blur of one pixel leaves of cos(2 pi m t), t from a void-and-cluster mask, with white
// noise as the unit: all of a constant, and a twelfth for each harmonic of the mask (measured for
// sigma 1.9, 64 x 64: 0.11, 0.20, 0.28, 0.34, 0.42, 0.51, 0.55, 0.66, 0.68, 0.78). A Gaussian of
// one pixel leaves 1 / (4 pi) of white noise.
double left_by_blur(int64_t m) {
    return m == 0 ? 4 * double(kPi) : std::min(1.0, double(m < 0 ? -m : m) / 12);
}

// The error of a lattice is the sum of the integrand's Fourier terms at the vectors of the dual
// lattice (Sloan & Joe, theorem 2.8), and a shift by t `along` turns the term at j, k by j m1 + k
// m2 times 2 pi t. Terms are expected to fall like those of Korobov's class, weight 1 / (h1 h2)^2.
double error_left(const IntCell& cell, int m1, int m2) {
    constexpr int kReach = 12;
    double sum = 0;
    for (int j = 0; j <= kReach; ++j)
        for (int k = -kReach; k <= kReach; ++k) {
            if (j == 0 && k <= 0) continue; // h and -h are one term
            const auto h1 = double(std::abs(j * cell.b.y - k * cell.a.y));
            const auto h2 = double(std::abs(k * cell.a.x - j * cell.b.x));
            const double product = std::max(1.0, h1) * std::max(1.0, h2);
            sum += left_by_blur(j * m1 + k * m2) / (product * product);
        }
    return sum;
}

// Of the vectors m1 a + m2 b that pass no other point of the lattice.
IntVector best_direction(const IntCell& cell) {
    constexpr int kReach = 5;
    double least = std::numeric_limits<double>::infinity();
    IntVector best{1, 0};
    for (int m1 = 0; m1 <= kReach; ++m1)
        for (int m2 = -kReach; m2 <= kReach; ++m2) {
            if (std::gcd(m1, m2) != 1) continue;
            const double left = error_left(cell, m1, m2);
            if (left >= least) continue;
            least = left;
            best = {m1 * cell.a.x + m2 * cell.b.x, m1 * cell.a.y + m2 * cell.b.y};
        }
    return best;
}

} // namespace

V2f LatticeCell::shift(const CellPlace& place) const {
    const V2f at = first * place.first + second * place.second + along * place.along;
    const auto wrapped = [](float x) { return std::min(x - std::floor(x), kBelowOne); };
    return {wrapped(at.x), wrapped(at.y)};
}

Lattice rank1_lattice(int n) {
    QL_CHECK(n >= 1);
    // Choose the step; as many again on either side of the golden ratio rarely find better ones.
    constexpr int64_t kReach = 32;
    const auto middle = int64_t(std::llround(kGolden * n));
    Lattice lattice;
    IntCell best{{1, 0}, {0, 1}};
    int64_t longest = 0;
    for (int64_t step = std::max<int64_t>(0, middle - kReach); step <= middle + kReach && step < n;
         ++step) {
        if (std::gcd(step, int64_t{n}) != 1) continue;
        const IntCell cell = reduced({{1, step}, {0, n}});
        if (cell.a.dot(cell.a) <= longest) continue;
        longest = cell.a.dot(cell.a);
        best = cell;
        lattice.step = int(step);
    }

    const auto scaled = [n](const IntVector& v) { return V2f(float(v.x), float(v.y)) / float(n); };
    lattice.cell = {scaled(best.a), scaled(best.b), scaled(best_direction(best))};
    return lattice;
}

} // namespace ql
