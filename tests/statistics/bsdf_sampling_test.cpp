#include "statistics/bsdf_cases.h"
#include "statistics/direction_histogram.h"

#include "sampling/random.h"
#include "shading/bsdf.h"

#include <gtest/gtest.h>

namespace ql {
namespace {

constexpr std::array<double, 6> kAngles = {0, 20, 45, 70, 85, 89.9};
constexpr uint64_t kSamples = 40000;
constexpr double kFamilyLevel = 0.01;

std::optional<BsdfSample> draw(const Bsdf& bsdf, const V3f& wo, uint64_t i) {
    const RandomFloats u = CounterRandom(2024, i).block(0);
    return sample_bsdf<kAllLobes>(bsdf, wo, u[0], {u[1], u[2]});
}

// The width of the narrowest lobe, radians.
double lobe_width(const Bsdf& b) {
    double width = 1;
    if (b.lobes & (kLobeMicrofacet | kLobeTransmission)) width = std::min(width, double{b.alpha});
    if (b.lobes & kLobePhong) width = std::min(width, 1 / std::sqrt(b.exponent + 1.0));
    return std::max(width, 1e-4);
}

// Where the chi-square cells are centred: on the mirror direction or on the refracted one.
V3f cell_axis(const Bsdf& b, const V3f& wo, bool transmitted) {
    if (!transmitted) return {-wo.x, -wo.y, wo.z};
    if (b.thin_walled) return -wo;
    const float eta = relative_eta(b);
    const float sine2 = (1 - wo.z * wo.z) / (eta * eta);
    return sine2 < 1 ? refracted(wo, {0, 0, 1}, eta) : V3f(0, 0, -1);
}

// One side of the surface: its directions follow the density, and the density integrates to the
// share of samples that went there.
struct SideResult {
    double count = 0;
    double integral = 0;
    double p_value = 1;
};

SideResult test_side(const Bsdf& bsdf, const V3f& wo, bool transmitted) {
    DirectionHistogram histogram(cell_axis(bsdf, wo, transmitted), lobe_width(bsdf) / 3);
    SideResult result;
    for (uint64_t i = 0; i < kSamples; ++i) {
        const auto sample = draw(bsdf, wo, i);
        if (!sample || sample->specular || sample->transmitted != transmitted) continue;
        histogram.add(sample->wi);
        ++result.count;
    }
    result.integral = histogram.integrate([&](const V3f& wi) {
        return (wi.z < 0) == transmitted ? double{pdf_bsdf<kAllLobes>(bsdf, wo, wi)} : 0.0;
    });
    if (result.integral > 0) result.p_value = histogram.test(result.count, result.integral).p_value;
    return result;
}

// A microfacet lobe at grazing angles is a streak alpha cos(theta) wide: too thin for the cells.
bool is_resolved(const Bsdf& b, const V3f& wo) {
    return !(b.lobes & (kLobeMicrofacet | kLobeTransmission)) || b.alpha * wo.z > 1e-5f;
}

TEST(BsdfSampling, FollowsItsDensity) {
    const std::vector<BsdfCase> cases = rough_cases();
    const double level = sidak_level(kFamilyLevel, cases.size() * kAngles.size() * 2);
    for (const BsdfCase& c : cases)
        for (const double angle : kAngles)
            for (const bool transmitted : {false, true}) {
                if (!is_resolved(c.bsdf, direction(angle))) continue;
                const SideResult r = test_side(c.bsdf, direction(angle), transmitted);
                EXPECT_GT(r.p_value, level)
                    << c.name << " at " << angle << (transmitted ? " t" : "");
                EXPECT_NEAR(r.integral, r.count / double{kSamples},
                            0.004 + 4 / std::sqrt(kSamples) / 2)
                    << c.name << " at " << angle << (transmitted ? " t" : "");
            }
}

// Where no direction can fall below the horizon nothing is lost: the density integrates to 1.
TEST(BsdfSampling, HasADensityThatIntegratesToOne) {
    for (const double angle : kAngles) {
        DirectionHistogram cells({0, 0, 1}, 0.1);
        const Bsdf b = lambert(0.5f);
        const V3f wo = direction(angle);
        EXPECT_NEAR(cells.integrate(
                        [&](const V3f& wi) { return double{pdf_bsdf<kLobeDiffuse>(b, wo, wi)}; }),
                    1, 1e-3);
    }
    for (const BsdfCase& c :
         {BsdfCase{"metal", metal(0.01f)}, BsdfCase{"phong", phong(0.3f, 0.6f, 400)}}) {
        DirectionHistogram cells({0, 0, 1}, 0.003);
        EXPECT_NEAR(cells.integrate([&](const V3f& wi) {
            return double{pdf_bsdf<kAllLobes>(c.bsdf, {0, 0, 1}, wi)};
        }),
                    1, 2e-3)
            << c.name;
    }
}

TEST(BsdfSampling, WeighsEachSampleWithValueOverDensity) {
    std::vector<BsdfCase> cases = rough_cases();
    for (const BsdfCase& c : cases)
        for (const double angle : {0.0, 45.0, 85.0, 89.9, 89.999})
            for (uint64_t i = 0; i < 2000; ++i) {
                const V3f wo = direction(angle);
                const auto sample = draw(c.bsdf, wo, i);
                if (!sample) continue;
                for (const float w : {sample->weight.x, sample->weight.y, sample->weight.z})
                    ASSERT_TRUE(std::isfinite(w) && w >= 0) << c.name << ' ' << angle;
                ASSERT_NEAR(sample->wi.length(), 1, 1e-4) << c.name << ' ' << angle;
                ASSERT_EQ(sample->transmitted, sample->wi.z < 0);
                if (sample->specular) {
                    ASSERT_EQ(sample->pdf_solid_angle, 0);
                    continue;
                }
                const BsdfValue v = value_and_pdf_bsdf<kAllLobes>(c.bsdf, wo, sample->wi);
                ASSERT_GT(v.pdf_solid_angle, 0) << c.name << ' ' << angle;
                ASSERT_EQ(v.pdf_solid_angle, sample->pdf_solid_angle) << c.name << ' ' << angle;
                ASSERT_LE((sample->weight - v.value / v.pdf_solid_angle).length(),
                          1e-5 * sample->weight.length())
                    << c.name << ' ' << angle;
            }
}

// No light is missed: nowhere is there a value without a density.
TEST(BsdfSampling, HasADensityWhereverThereIsAValue) {
    for (const BsdfCase& c : rough_cases())
        for (const double angle : {0.0, 30.0, 60.0, 85.0, 89.9, 89.999})
            for (uint64_t i = 0; i < 3000; ++i) {
                const RandomFloats u = CounterRandom(5, i).block(0);
                const V3f wi = square_to_uniform_sphere({u[0], u[1]});
                const BsdfValue v = value_and_pdf_bsdf<kAllLobes>(c.bsdf, direction(angle), wi);
                for (const float x : {v.value.x, v.value.y, v.value.z, v.pdf_solid_angle})
                    ASSERT_TRUE(std::isfinite(x) && x >= 0) << c.name << ' ' << angle;
                ASSERT_EQ(v.value.length() > 0 && v.pdf_solid_angle == 0, false)
                    << c.name << ' ' << angle << ' ' << wi;
            }
}

// Kernels for fewer lobes do what the kernel for all lobes does.
TEST(BsdfSampling, IsTheSameInEveryKernel) {
    const V3f wo = direction(50);
    for (uint64_t i = 0; i < 500; ++i) {
        const RandomFloats u = CounterRandom(9, i).block(0);
        const V2f point(u[1], u[2]);
        const auto check = [&](const auto& a, const auto& b) {
            ASSERT_EQ(a.has_value(), b.has_value());
            if (!a) return;
            ASSERT_LE((a->wi - b->wi).length(), 1e-6);
            ASSERT_LE((a->weight - b->weight).length(), 1e-5);
            ASSERT_NEAR(a->pdf_solid_angle, b->pdf_solid_angle, 1e-5 * b->pdf_solid_angle);
        };
        check(sample_bsdf<kLobeDiffuse>(lambert(0.7f), wo, u[0], point),
              sample_bsdf<kAllLobes>(lambert(0.7f), wo, u[0], point));
        constexpr uint32_t kOpaque = kLobeDiffuse | kLobeMicrofacet;
        for (const Bsdf& b : {coated(0.3f, 1.5f), coated(0, 1.5f), metal(0.2f), metal(0)})
            check(sample_bsdf<kOpaque>(b, wo, u[0], point),
                  sample_bsdf<kAllLobes>(b, wo, u[0], point));
    }
}

} // namespace
} // namespace ql
