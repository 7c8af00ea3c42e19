#include "shading/bsdf_fresnel.h"

#include "reference/bsdf_reference.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

TEST(DielectricFresnel, EqualsTheClosedFormAtNormalIncidence) {
    for (const float eta : {0.5f, 1 / 1.5f, 1.1f, 1.45f, 1.5f, 2.4f, 100.0f}) {
        const double r = (double{eta} - 1) / (double{eta} + 1);
        EXPECT_NEAR(dielectric_fresnel(1, eta), r * r, 1e-6 * r * r) << eta;
    }
}

// At Brewster's angle tan(theta) = eta the parallel part is zero and the other ((e^2-1)/(e^2+1))^2.
TEST(DielectricFresnel, EqualsTheClosedFormAtBrewstersAngle) {
    for (const double eta : {1 / 1.5, 1.1, 1.5, 2.4}) {
        const double cosine = 1 / std::sqrt(1 + eta * eta);
        const double rs = (eta * eta - 1) / (eta * eta + 1);
        EXPECT_NEAR(dielectric_fresnel(static_cast<float>(cosine), static_cast<float>(eta)),
                    rs * rs / 2, 1e-6)
            << eta;
    }
}

TEST(DielectricFresnel, ReflectsAllBeyondTheCriticalAngle) {
    const float eta = 1 / 1.5f;
    const float critical_cosine = std::sqrt(1 - eta * eta);
    EXPECT_EQ(dielectric_fresnel(critical_cosine * 0.999f, eta), 1);
    EXPECT_EQ(dielectric_fresnel(0, eta), 1);
    EXPECT_LT(dielectric_fresnel(critical_cosine * 1.001f, eta), 0.95f);
    EXPECT_EQ(dielectric_fresnel(1, 0), 1); // index 0
}

TEST(DielectricFresnel, ReflectsAllAtGrazingAngles) {
    for (const float eta : {0.7f, 1.0001f, 1.5f, 100.0f})
        EXPECT_NEAR(dielectric_fresnel(0, eta), 1, 1e-6) << eta;
}

TEST(DielectricFresnel, IsZeroWithoutABoundary) {
    for (const float cosine : {0.0f, 1e-30f, 1e-3f, 0.5f, 1.0f})
        EXPECT_EQ(dielectric_fresnel(cosine, 1), 0);
}

TEST(DielectricFresnel, AgreesWithFresnelsEquationsInDoublePrecision) {
    for (const float eta : {0.01f, 0.5f, 0.9f, 1.01f, 1.1f, 1.5f, 3.0f, 100.0f})
        for (int i = 0; i <= 1000; ++i) {
            const float cosine = static_cast<float>(i) / 1000;
            const double expected = reference::fresnel(cosine, eta);
            // The slope is infinite at the critical angle.
            const bool critical =
                std::abs(double{cosine} * cosine - (1 - double{eta} * eta)) < 1e-4;
            EXPECT_NEAR(dielectric_fresnel(cosine, eta), expected, critical ? 0.03 : 2e-6)
                << eta << ' ' << cosine;
        }
}

// The usual form in float loses 9 % here.
TEST(DielectricFresnel, KeepsItsDigitsForAnIndexNearOne) {
    for (const double excess : {1e-6, 1e-5, 1e-4, 1e-3}) {
        const float eta = static_cast<float>(1 + excess);
        const double r = (double{eta} - 1) / (double{eta} + 1);
        EXPECT_NEAR(dielectric_fresnel(1, eta) / (r * r), 1, 1e-5) << excess;
    }
}

TEST(DielectricFresnel, IsTheSameFromBothSides) {
    const float eta = 1.5f;
    for (int i = 1; i <= 100; ++i) {
        const float cos_i = static_cast<float>(i) / 100;
        const float cos_t = std::sqrt(1 - (1 - cos_i * cos_i) / (eta * eta));
        EXPECT_NEAR(dielectric_fresnel(cos_i, eta), dielectric_fresnel(cos_t, 1 / eta), 1e-4);
    }
}

TEST(SchlickFresnel, FollowsTheThesis) {
    EXPECT_NEAR(schlick_dielectric_fresnel(1, 1.5f), 0.04, 1e-7);
    EXPECT_NEAR(schlick_dielectric_fresnel(0.5f, 1.5f), 0.04 + 0.96 / 32, 1e-6);
    EXPECT_EQ(schlick_dielectric_fresnel(0, 1.5f), 1);
    EXPECT_EQ(schlick_dielectric_fresnel(0.5f, 1 / 1.5f), 1); // total internal reflection
}

} // namespace
} // namespace ql
