#include "reference/bsdf_reference.h"
#include "statistics/bsdf_cases.h"

#include "sampling/random.h"
#include "shading/bsdf.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

constexpr std::array<double, 7> kAngles = {0, 30, 60, 80, 89, 89.9, 89.999};

// Directional albedo in flux: what a white surrounding of radiance 1 shows, with the number of
// lobe samples that a low-discrepancy sequence makes exact to 1e-3 (Roberts' R3 sequence).
double furnace(const Bsdf& bsdf, const V3f& wo, int samples = 20000) {
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const auto u = [&](double step) {
            const double x = 0.5 + step * (i + 1);
            return static_cast<float>(std::min(x - std::floor(x), 1 - 0x1p-24));
        };
        const V2f point(u(0.6710436067037893), u(0.5497004779019703));
        const auto sample = sample_bsdf<kAllLobes, TransportMode::importance>(
            bsdf, wo, u(0.8191725133961645), point);
        if (sample) sum += (sample->weight.x + sample->weight.y + sample->weight.z) / 3.0;
    }
    return sum / samples;
}

TEST(WhiteFurnace, IsExactForLambertMirrorAndSmoothDielectrics) {
    const std::vector<BsdfCase> cases = {
        {"lambert", lambert(1)},
        {"metal mirror", metal(0)},
        {"phong mirror", phong_glass(1, 0, 1.5f, Wall::solid_from_outside)},
        {"glass", phong_glass(0.5f, 0.5f, 1.45f, Wall::solid_from_outside)},
        {"glass from inside", phong_glass(0, 1, 1.45f, Wall::solid_from_inside)},
        {"no boundary", phong_glass(0.3f, 0.7f, 1, Wall::solid_from_outside)},
        {"index 0", phong_glass(0.3f, 0.7f, 0, Wall::solid_from_outside)},
        {"index 1 + 1e-6", phong_glass(0, 1, 1.000001f, Wall::solid_from_inside)},
        {"index 100", phong_glass(0, 1, 100, Wall::solid_from_outside)},
        {"thin wall", glass(0, 1.5f, Wall::thin)},
        {"solid", glass(0, 1.5f, Wall::solid_from_outside)},
        {"solid from inside", glass(0, 1.5f, Wall::solid_from_inside)},
        {"coat of index 1", coated(0.5f, 1)}};
    for (const BsdfCase& c : cases)
        for (const double angle : kAngles)
            EXPECT_NEAR(furnace(c.bsdf, direction(angle)), 1, 0.002) << c.name << " at " << angle;
}

TEST(WhiteFurnace, IsExactForTheSchlickGlassOfTheThesis) {
    Bsdf b = phong_glass(0, 1, 1.45f, Wall::solid_from_outside);
    b.schlick = true;
    for (const double angle : kAngles)
        EXPECT_NEAR(furnace(b, direction(angle)), 1, 0.002) << angle;
}

TEST(WhiteFurnace, LosesForGgxWhatSingleScatteringLoses) {
    for (const float alpha : {0.001f, 0.01f, 0.1f, 0.3f, 0.6f, 1.0f})
        for (const double angle : kAngles) {
            const V3f wo = direction(angle);
            const double expected = reference::ggx_albedo(wo.z, alpha);
            EXPECT_NEAR(furnace(metal(alpha), wo), expected, 0.003) << alpha << " at " << angle;
            EXPECT_LE(expected, 1.0005) << alpha << " at " << angle;
        }
}

TEST(WhiteFurnace, NeverGainsUnderACoat) {
    for (const float eta : {1.000001f, 1.1f, 1.5f, 3.0f, 100.0f})
        for (const float alpha : {0.0f, 0.01f, 0.1f, 0.3f, 0.6f, 1.0f})
            for (const double angle : {0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 89.999})
                EXPECT_LE(furnace(coated(alpha, eta), direction(angle), 5000), 1.003)
                    << eta << ' ' << alpha << " at " << angle;
}

// A smooth coat over what reflects all: F(o) and, of the rest, what leaves again.
double coat_albedo(double cosine, double eta) {
    constexpr int kSteps = 4000;
    const double outer = reference::fresnel(cosine, eta);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        const double c = (i + 0.5) / kSteps;
        sum += (1 - std::max(outer, reference::fresnel(c, eta))) * 2 * c / kSteps;
    }
    return outer + sum;
}

TEST(WhiteFurnace, LosesUnderASmoothCoatWhatTheFormulaLoses) {
    for (const float eta : {1.1f, 1.5f, 3.0f})
        for (const double angle : {0.0, 45.0, 75.0}) {
            const V3f wo = direction(angle);
            EXPECT_NEAR(furnace(coated(0, eta), wo, 20000), coat_albedo(double(wo.z), double(eta)),
                        0.003)
                << eta << " at " << angle;
        }
}

TEST(WhiteFurnace, NeverGainsInRoughGlass) {
    for (const Wall wall : {Wall::thin, Wall::solid_from_outside, Wall::solid_from_inside})
        for (const float eta : {1.000001f, 1.01f, 1.5f, 3.0f})
            for (const float alpha : {0.001f, 0.1f, 0.5f, 1.0f})
                for (const double angle : kAngles) {
                    const double albedo = furnace(glass(alpha, eta, wall), direction(angle), 5000);
                    EXPECT_LE(albedo, 1.003) << eta << ' ' << alpha << " at " << angle;
                    // Towards grazing, masking takes most of what an index near 1 should let pass.
                    const double least = angle <= 60 ? 0.3 : 0.0;
                    EXPECT_GT(albedo, least) << eta << ' ' << alpha << " at " << angle;
                }
}

// The lobe of the thesis is exact at normal incidence and loses towards grazing: half of the lobe
// falls below the horizon, and the rest is weighed with a cosine that goes to zero.
TEST(WhiteFurnace, LosesForPhongWhatTheLobeLoses) {
    for (const float exponent : {0.0f, 1.0f, 40.0f, 1e4f, 1e6f}) {
        EXPECT_NEAR(furnace(phong(0, 1, exponent), direction(0)), 1, 0.003) << exponent;
        for (const double angle : kAngles) {
            const V3f wo = direction(angle);
            const double albedo = furnace(phong(0, 1, exponent), wo);
            EXPECT_NEAR(albedo, reference::phong_albedo(wo.z, exponent), 0.004)
                << exponent << " at " << angle;
            EXPECT_LE(albedo, 1.002);
        }
    }
}

TEST(WhiteFurnace, PassesFromThePhongLobeToItsLimitWithoutAStep) {
    for (const double angle : {0.0, 30.0, 60.0, 80.0}) {
        const V3f wo = direction(angle);
        EXPECT_NEAR(furnace(phong(0, 1, 2e6f), wo), furnace(phong(0, 1, 1e6f), wo), 0.002);
        EXPECT_NEAR(furnace(phong(0, 1, 2e6f), wo), wo.z, 1e-6);
    }
}

// --- Reciprocity ---------------------------------------------------------------------------------

V3f flipped(const V3f& v) {
    return {v.x, v.y, -v.z};
}

TEST(Reciprocity, HoldsForEveryReflection) {
    for (const BsdfCase& c : rough_cases())
        for (uint64_t i = 0; i < 500; ++i) {
            const RandomFloats u = CounterRandom(77, i).block(0);
            const V3f a = square_to_uniform_hemisphere({u[0], u[1]});
            const V3f b = square_to_uniform_hemisphere({u[2], u[3]});
            const V3f forth = eval_bsdf<kAllLobes>(c.bsdf, a, b) / b.z;
            const V3f back = eval_bsdf<kAllLobes>(c.bsdf, b, a) / a.z;
            EXPECT_LE((forth - back).length(), 2e-3 * forth.length() + 1e-6) << c.name;
        }
}

// Light paths and camera paths see the same surface: f*(a, b) = f(b, a), and radiance changes by
// the square of the index (Veach 1997, eq. 5.14 and 5.15).
TEST(Reciprocity, HoldsForTransmissionInBothModes) {
    for (const float alpha : {0.1f, 0.5f})
        for (const Wall wall : {Wall::thin, Wall::solid_from_outside}) {
            const Bsdf outside = glass(alpha, 1.5f, wall);
            Bsdf inside = outside;
            inside.entering = false;
            int lit = 0;
            for (uint64_t i = 0; i < 2000; ++i) {
                const RandomFloats u = CounterRandom(78, i).block(0);
                const V3f a = square_to_uniform_hemisphere({u[0], u[1]});
                const V3f b = flipped(square_to_uniform_hemisphere({u[2], u[3]}));
                const V3f radiance = eval_bsdf<kAllLobes>(outside, a, b) / -b.z;
                const V3f importance =
                    eval_bsdf<kAllLobes, TransportMode::importance>(outside, a, b) / -b.z;
                const V3f back = eval_bsdf<kAllLobes>(inside, flipped(b), flipped(a)) / a.z;
                const float scale = wall == Wall::thin ? 1 : 1.5f * 1.5f;
                EXPECT_LE((importance - back).length(), 2e-3 * back.length() + 1e-5);
                EXPECT_LE((radiance * scale - back).length(), 2e-3 * back.length() + 1e-5);
                lit += back.length() > 1e-3;
            }
            EXPECT_GT(lit, 50);
        }
}

TEST(SmoothRefraction, ObeysSnellAndScalesRadiance) {
    const V3f wo = direction(40);
    const Bsdf b = phong_glass(0, 1, 1.5f, Wall::solid_from_outside);
    const auto sample = sample_bsdf<kAllLobes>(b, wo, 0.999f, {0.5f, 0.5f});
    ASSERT_TRUE(sample && sample->transmitted && sample->specular);
    EXPECT_NEAR(std::sqrt(1 - sample->wi.z * sample->wi.z) * 1.5, std::sin(40 * M_PI / 180), 1e-6);
    EXPECT_NEAR(sample->weight.x, 1 / 2.25, 1e-5);
    const auto flux =
        sample_bsdf<kAllLobes, TransportMode::importance>(b, wo, 0.999f, {0.5f, 0.5f});
    EXPECT_NEAR(flux->weight.x, 1, 1e-5);
}

} // namespace
} // namespace ql
