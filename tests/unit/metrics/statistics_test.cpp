#include "metrics/statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

namespace ql {
namespace {

TEST(GammaQ, EqualsClosedForms) {
    for (const double x : {1e-6, 0.1, 0.9, 1.0, 2.5, 30.0, 500.0}) {
        EXPECT_NEAR(gamma_q(1, x) / std::exp(-x), 1, 1e-12) << x;
        EXPECT_NEAR(gamma_q(0.5, x), std::erfc(std::sqrt(x)), 1e-13) << x;
        EXPECT_NEAR(gamma_q(3, x) / (std::exp(-x) * (1 + x + x * x / 2)), 1, 1e-11) << x;
    }
    EXPECT_EQ(gamma_q(2, 0), 1);
    EXPECT_EQ(gamma_q(2, std::numeric_limits<double>::infinity()), 0);
}

TEST(GammaQ, IsAccurateForManyDegreesOfFreedom) {
    // The median of the gamma distribution is a - 1/3 + 8/(405 a) + O(a^-2).
    for (const double a : {100.0, 1e4, 1e6})
        EXPECT_NEAR(gamma_q(a, a - 1.0 / 3 + 8 / (405 * a)), 0.5, 1e-6) << a;
}

TEST(IncompleteBeta, EqualsClosedForms) {
    for (const double x : {0.0, 0.01, 0.3, 0.5, 0.77, 1.0}) {
        EXPECT_NEAR(incomplete_beta(1, 1, x), x, 1e-14);
        EXPECT_NEAR(incomplete_beta(2, 1, x), x * x, 1e-14);
        EXPECT_NEAR(incomplete_beta(1, 3, x), 1 - std::pow(1 - x, 3), 1e-14);
        EXPECT_NEAR(incomplete_beta(0.5, 0.5, x), 2 / M_PI * std::asin(std::sqrt(x)), 1e-12);
    }
}

// Quantiles of the chi-square table: 3.841 (1, 5 %), 16.919 (9, 5 %), 124.342 (100, 5 %).
TEST(ChiSquare, GivesTheProbabilitiesOfTheTable) {
    EXPECT_NEAR(gamma_q(0.5, 3.841458821 / 2), 0.05, 1e-9);
    EXPECT_NEAR(gamma_q(4.5, 16.918977605 / 2), 0.05, 1e-9);
    EXPECT_NEAR(gamma_q(50, 124.342113404 / 2), 0.05, 1e-9);
}

// Mendel's peas: 315, 108, 101, 32 against 9:3:3:1 give 0.470 with 3 degrees of freedom, p = 0.925.
TEST(ChiSquare, EqualsATextbookExample) {
    const std::array<uint64_t, 4> observed = {315, 108, 101, 32};
    const std::array<double, 4> expected = {312.75, 104.25, 104.25, 34.75};
    const TestResult r = chi_square_test(observed, expected);
    EXPECT_NEAR(r.statistic, 0.470024, 1e-6);
    EXPECT_EQ(r.degrees_of_freedom, 3);
    EXPECT_NEAR(r.p_value, 0.925426, 1e-6);
}

TEST(ChiSquare, PoolsCellsThatExpectLittle) {
    const std::array<uint64_t, 6> observed = {1, 3, 2, 0, 50, 44};
    const std::array<double, 6> expected = {1, 2, 2, 1, 47, 47};
    const TestResult r = chi_square_test(observed, expected);
    // 1 + 1 + 2 + 2 = 6 expected and 6 seen in the pool.
    EXPECT_EQ(r.degrees_of_freedom, 2);
    EXPECT_NEAR(r.statistic, 18.0 / 47, 1e-12);
}

TEST(ChiSquare, RejectsACountWhereNothingIsExpected) {
    const std::array<uint64_t, 3> observed = {1, 50, 50};
    const std::array<double, 3> expected = {0, 50, 50};
    EXPECT_EQ(chi_square_test(observed, expected).p_value, 0);
}

// Welch's test on the data of R's documentation: t.test(extra ~ group, data = sleep).
TEST(Welch, EqualsTheSleepDataOfStudent) {
    const std::array<double, 10> first = {0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0};
    const std::array<double, 10> second = {1.9, 0.8, 1.1, 0.1, -0.1, 4.4, 5.5, 1.6, 4.6, 3.4};
    const TestResult r = welch_test(sample_moments(first), sample_moments(second));
    EXPECT_NEAR(r.statistic, -1.8608, 1e-4);
    EXPECT_NEAR(r.degrees_of_freedom, 17.776, 1e-3);
    EXPECT_NEAR(r.p_value, 0.07939, 1e-5);
}

TEST(Welch, DecidesConstantSamplesExactly) {
    const SampleMoments one{1, 0, 10}, two{2, 0, 10};
    EXPECT_EQ(welch_test(one, one).p_value, 1);
    EXPECT_EQ(welch_test(one, two).p_value, 0);
}

TEST(ZTest, GivesTheProbabilitiesOfTheTable) {
    EXPECT_NEAR(z_test(1.959963985, 0, 1).p_value, 0.05, 1e-9);
    EXPECT_NEAR(z_test(10 - 2 * 2.575829304, 10, 2).p_value, 0.01, 1e-9);
    EXPECT_EQ(z_test(3, 3, 1).p_value, 1);
}

TEST(Sidak, GivesTheFamilyItsLevel) {
    EXPECT_NEAR(1 - std::pow(1 - sidak_level(0.01, 50), 50), 0.01, 1e-12);
    EXPECT_EQ(sidak_level(0.05, 1), 0.05);
}

} // namespace
} // namespace ql
