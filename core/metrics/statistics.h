// Statistical tests, for the measurements and for the tests of the suite. All in double precision;
// pure functions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace ql {

// Regularised upper incomplete gamma function Q(a, x), a > 0, x >= 0: series and Lentz's continued
// fraction (Abramowitz & Stegun 6.5.29, 6.5.31).
double gamma_q(double a, double x);

// Regularised incomplete beta function I_x(a, b), a, b > 0, x in [0, 1]: Lentz's continued fraction
// (Abramowitz & Stegun 26.5.8).
double incomplete_beta(double a, double b, double x);

struct TestResult {
    double statistic = 0;
    double degrees_of_freedom = 0; // 0 where the test has none
    double p_value = 1;
};

// Pearson's chi-square test of counts against expected counts, which need not have the same sum to
// the last digit. Cells are pooled, smallest expectation first, until each pool expects at least
// `minimum_expected` (Cochran 1954: 5). A count where nothing is expected gives p = 0; fewer than
// two pools give p = 1.
TestResult chi_square_test(std::span<const uint64_t> observed, std::span<const double> expected,
                           double minimum_expected = 5);

// Mean and unbiased variance of a sample of independent values.
struct SampleMoments {
    double mean = 0;
    double variance = 0;
    uint64_t count = 0;
};
SampleMoments sample_moments(std::span<const double> values);

// Two-sided test that two samples have the same mean (Welch 1947). Equal constant samples give
// p = 1, different ones p = 0. Both need at least two values.
TestResult welch_test(const SampleMoments& a, const SampleMoments& b);

// Two-sided test that a normal value with known standard error has the given mean.
TestResult z_test(double value, double mean, double standard_error);

// The level for each of n independent tests so that all together have level alpha (Sidak 1967).
double sidak_level(double alpha, size_t n);

} // namespace ql
