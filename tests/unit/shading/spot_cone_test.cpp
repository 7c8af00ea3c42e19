#include "shading/spot_cone.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ql {
namespace {

// h = 1 - cos of angles with these cosines.
SpotCone cone(double cos_inner, double cos_outer, double exponent) {
    return {float(1 - cos_inner), float(1 - cos_outer), float(exponent)};
}

double summed_falloff(const SpotCone& spot) {
    constexpr int kSteps = 200000;
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double t = (i + 0.5) / kSteps; // h = outer t^3, for lobes narrower than the cone
        sum += double(spot.falloff(float(t * t * t) * spot.outer)) * 3 * t * t;
    }
    return sum / kSteps * double(spot.outer);
}

TEST(SpotCone, FallsOffAsTheSourcesSay) {
    EXPECT_EQ(cone(1, 0.6, -1).falloff(0.5f), 0);
    EXPECT_EQ(cone(0.9, 0.6, -1).falloff(0.05f), 1);
    EXPECT_NEAR(cone(0.9, 0.6, -1).falloff(0.25f), 0.25f, 1e-6f);
    EXPECT_EQ(cone(1, 0.6, 3).falloff(0.5f), 0);
    EXPECT_NEAR(cone(1, 0.6, 3).falloff(0.2f), 0.512f, 1e-6f);
    EXPECT_EQ(cone(1, 0.6, 0).falloff(0.2f), 1);
    EXPECT_NEAR(cone(0.8, 0.8, -1).falloff(0.2f), 0, 1e-6f); // without width it starts at its edge
}

TEST(SpotCone, IntegralIsThatOfTheFalloffDownToNarrowCones) {
    for (const double degrees : {90.0, 40.0, 1.0, 0.1, 0.01, 1e-3})
        for (const double exponent : {-1.0, 0.0, 1.0, 50.0, 1e6}) {
            const double outer = degrees * M_PI / 180;
            for (const double inner : {0.0, 0.5 * outer, outer}) {
                const SpotCone spot = spot_cone(inner, outer, exponent);
                EXPECT_NEAR(summed_falloff(spot) / spot.integral(), 1, 2e-3)
                    << degrees << " degrees, exponent " << exponent;
            }
        }
}

TEST(SpotCone, SamplesFollowTheFalloff) {
    for (const double degrees : {90.0, 1.0, 0.01})
        for (const double exponent : {-1.0, 0.0, 20.0}) {
            const double outer = degrees * M_PI / 180;
            const SpotCone spot = spot_cone(0.7 * outer, outer, exponent);
            // The mean of h by samples, and by the density falloff / integral
            constexpr int kSteps = 100000;
            double sampled = 0, expected = 0;
            for (int i = 0; i < kSteps; ++i) {
                const double u = (i + 0.5) / kSteps;
                const double h = spot.sample(u);
                EXPECT_GE(h, 0);
                EXPECT_LE(h, double(spot.outer) * (1 + 1e-6));
                sampled += h / kSteps;
                const double at = u * double(spot.outer);
                expected += at * double(spot.falloff(float(at))) * double(spot.outer) / kSteps;
            }
            EXPECT_NEAR(sampled / (expected / spot.integral()), 1, 1e-3) << degrees;
        }
}

} // namespace
} // namespace ql
