#include "metrics/statistics.h"

#include "base/check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

namespace ql {

namespace {

constexpr double kTiny = 1e-300;
constexpr double kPrecision = 1e-15;
constexpr int kMaxTerms = 100000;

// P(a, x) by its series, for x < a + 1.
double gamma_p_series(double a, double x) {
    double term = 1 / a;
    double sum = term;
    for (int n = 1; n < kMaxTerms && term > sum * kPrecision; ++n) {
        term *= x / (a + n);
        sum += term;
    }
    return sum * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

// Q(a, x) by its continued fraction, for x >= a + 1 (modified Lentz).
double gamma_q_fraction(double a, double x) {
    double b = x + 1 - a;
    double c = 1 / kTiny;
    double d = 1 / b;
    double h = d;
    for (int n = 1; n < kMaxTerms; ++n) {
        const double an = -n * (n - a);
        b += 2;
        d = an * d + b;
        d = 1 / (std::abs(d) < kTiny ? kTiny : d);
        c = b + an / c;
        if (std::abs(c) < kTiny) c = kTiny;
        h *= d * c;
        if (std::abs(d * c - 1) < kPrecision) break;
    }
    return h * std::exp(-x + a * std::log(x) - std::lgamma(a));
}

double beta_fraction(double a, double b, double x) {
    double c = 1;
    double d = 1 - (a + b) * x / (a + 1);
    d = 1 / (std::abs(d) < kTiny ? kTiny : d);
    double h = d;
    const auto step = [&](double numerator) {
        d = 1 + numerator * d;
        d = 1 / (std::abs(d) < kTiny ? kTiny : d);
        c = 1 + numerator / c;
        if (std::abs(c) < kTiny) c = kTiny;
        h *= d * c;
        return std::abs(d * c - 1);
    };
    for (int m = 1; m < kMaxTerms; ++m) {
        step(m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m)));
        if (step(-(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1))) < kPrecision) break;
    }
    return h;
}

} // namespace

double gamma_q(double a, double x) {
    QL_CHECK(a > 0 && x >= 0);
    if (x == 0) return 1;
    if (std::isinf(x)) return 0;
    return x < a + 1 ? 1 - gamma_p_series(a, x) : gamma_q_fraction(a, x);
}

double incomplete_beta(double a, double b, double x) {
    QL_CHECK(a > 0 && b > 0 && x >= 0 && x <= 1);
    if (x == 0 || x == 1) return x;
    const double front = std::exp(std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) +
                                  a * std::log(x) + b * std::log1p(-x));
    // The fraction converges fast below the mean; beyond it use the symmetry.
    if (x < (a + 1) / (a + b + 2)) return front * beta_fraction(a, b, x) / a;
    return 1 - front * beta_fraction(b, a, 1 - x) / b;
}

TestResult chi_square_test(std::span<const uint64_t> observed, std::span<const double> expected,
                           double minimum_expected) {
    QL_CHECK_EQ(observed.size(), expected.size());
    std::vector<size_t> order(expected.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](size_t a, size_t b) { return expected[a] < expected[b]; });

    // Pool the cells of low expectation. What is left over goes to the last pool.
    struct Pool {
        double observed = 0;
        double expected = 0;
    };
    std::vector<Pool> pools;
    Pool open;
    for (const size_t i : order) {
        if (expected[i] <= 0) {
            if (observed[i] > 0) return {std::numeric_limits<double>::infinity(), 0, 0};
            continue;
        }
        open.observed += static_cast<double>(observed[i]);
        open.expected += expected[i];
        if (open.expected < minimum_expected) continue;
        pools.push_back(open);
        open = {};
    }
    if (!pools.empty()) {
        pools.back().observed += open.observed;
        pools.back().expected += open.expected;
    }
    if (pools.size() < 2) return {};

    TestResult result;
    for (const Pool& pool : pools) {
        const double difference = pool.observed - pool.expected;
        result.statistic += difference * difference / pool.expected;
    }
    result.degrees_of_freedom = static_cast<double>(pools.size() - 1);
    result.p_value = gamma_q(result.degrees_of_freedom / 2, result.statistic / 2);
    return result;
}

SampleMoments sample_moments(std::span<const double> values) {
    SampleMoments m;
    m.count = values.size();
    if (values.empty()) return m;
    m.mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(m.count);
    double squares = 0;
    for (const double v : values)
        squares += (v - m.mean) * (v - m.mean);
    m.variance = m.count > 1 ? squares / static_cast<double>(m.count - 1) : 0;
    return m;
}

TestResult welch_test(const SampleMoments& a, const SampleMoments& b) {
    QL_CHECK(a.count >= 2 && b.count >= 2);
    const double na = static_cast<double>(a.count);
    const double nb = static_cast<double>(b.count);
    const double va = a.variance / na;
    const double vb = b.variance / nb;
    const double difference = a.mean - b.mean;
    if (va + vb == 0) {
        if (difference == 0) return {0, na + nb - 2, 1};
        return {std::copysign(std::numeric_limits<double>::infinity(), difference), na + nb - 2, 0};
    }
    // Welch-Satterthwaite; p = I_{df / (df + t^2)}(df / 2, 1 / 2) (Abramowitz & Stegun 26.5.27).
    const double t = difference / std::sqrt(va + vb);
    const double df = (va + vb) * (va + vb) / (va * va / (na - 1) + vb * vb / (nb - 1));
    return {t, df, incomplete_beta(df / 2, 0.5, df / (df + t * t))};
}

TestResult z_test(double value, double mean, double standard_error) {
    QL_CHECK(standard_error > 0);
    const double z = (value - mean) / standard_error;
    return {z, 0, std::erfc(std::abs(z) / std::sqrt(2.0))};
}

double sidak_level(double alpha, size_t n) {
    QL_CHECK(alpha > 0 && alpha < 1 && n > 0);
    return -std::expm1(std::log1p(-alpha) / static_cast<double>(n));
}

} // namespace ql
