#include "shading/bsdf.h"

#include <gtest/gtest.h>

#include <limits>

namespace ql {
namespace {

TEST(Bsdf, ScattersNothingWithoutLobes) {
    Bsdf b;
    b.lobes = 0;
    EXPECT_FALSE(sample_bsdf<kAllLobes>(b, {0, 0, 1}, 0.5f, {0.5f, 0.5f}));
    EXPECT_EQ(eval_bsdf<kAllLobes>(b, {0, 0, 1}, {0, 0, 1}), V3f(0));
    EXPECT_EQ(pdf_bsdf<kAllLobes>(b, {0, 0, 1}, {0, 0, 1}), 0);
    // A kernel for Lambert surfaces sees the albedo 0.
    EXPECT_EQ(sample_bsdf<kLobeDiffuse>(b, {0, 0, 1}, 0.5f, {0.4f, 0.5f})->weight, V3f(0));
}

TEST(Bsdf, ScattersNothingBelowTheHorizon) {
    Bsdf b;
    b.diffuse = V3f(1);
    EXPECT_EQ(eval_bsdf<kLobeDiffuse>(b, {0, 0, 1}, {0.6f, 0, -0.8f}), V3f(0));
    EXPECT_EQ(pdf_bsdf<kLobeDiffuse>(b, {0, 0, 1}, {0.6f, 0, -0.8f}), 0);
    EXPECT_EQ(eval_bsdf<kLobeDiffuse>(b, {0.6f, 0, -0.8f}, {0, 0, 1}), V3f(0));
    EXPECT_FALSE(sample_bsdf<kAllLobes>(b, {0.6f, 0, -0.8f}, 0.5f, {0.4f, 0.5f}));
}

TEST(Bsdf, OfIndexOneIsExactlyLambert) {
    Bsdf lambert;
    lambert.diffuse = V3f(0.3f, 0.5f, 0.7f);
    Bsdf coated = lambert;
    coated.lobes |= kLobeMicrofacet;
    coated.eta = 1;
    coated.alpha = 0.5f;
    const V3f wo(0.6f, 0, 0.8f), wi(0, -0.8f, 0.6f);
    EXPECT_EQ(eval_bsdf<kAllLobes>(coated, wo, wi), eval_bsdf<kLobeDiffuse>(lambert, wo, wi));
}

TEST(Bsdf, ReflectsPerfectlyAtOrBelowTheSmoothWidth) {
    Bsdf b;
    b.lobes = kLobeMicrofacet;
    b.metallic = 1;
    b.metal_f0 = V3f(1, 0.5f, 0);
    b.alpha = kSmoothAlpha;
    const V3f wo(0.6f, 0, 0.8f);
    const auto s = sample_bsdf<kLobeDiffuse | kLobeMicrofacet>(b, wo, 0.5f, {0.3f, 0.3f});
    ASSERT_TRUE(s);
    EXPECT_TRUE(s->specular);
    EXPECT_EQ(s->wi, V3f(-0.6f, 0, 0.8f));
    EXPECT_NEAR(s->weight.y, 0.5 + 0.5 * std::pow(0.2, 5), 1e-6);
    EXPECT_EQ(eval_bsdf<kAllLobes>(b, wo, s->wi), V3f(0));
    b.alpha = 2 * kSmoothAlpha;
    EXPECT_FALSE(sample_bsdf<kAllLobes>(b, wo, 0.5f, {0.3f, 0.3f})->specular);
}

TEST(Bsdf, PhongLobeHasTheValueOfTheThesis) {
    Bsdf b;
    b.lobes = kLobePhong;
    b.phong = V3f(0.5f);
    b.exponent = 40;
    const V3f wo(0.6f, 0, 0.8f), wi(-0.8f, 0, 0.6f);
    const double cosine = 0.6 * 0.8 + 0.8 * 0.6; // between wi and the mirror direction
    EXPECT_NEAR(eval_bsdf<kAllLobes>(b, wo, wi).x,
                0.5 * 42 / (2 * M_PI) * std::pow(cosine, 40) * 0.6, 1e-5);
    EXPECT_NEAR(pdf_bsdf<kAllLobes>(b, wo, wi), 41 / (2 * M_PI) * std::pow(cosine, 40), 1e-5);
}

TEST(Bsdf, SplitsReflectionAndRefractionByFresnel) {
    Bsdf b;
    b.lobes = kLobeSpecular;
    b.mirror = V3f(0.2f);
    b.refraction = V3f(0.6f);
    b.thin_walled = false;
    b.eta = 1.5f;
    int reflected = 0;
    for (int i = 0; i < 1000; ++i) {
        const float u = (static_cast<float>(i) + 0.5f) / 1000;
        const auto s = sample_bsdf<kAllLobes>(b, {0, 0, 1}, u, {0.5f, 0.5f});
        ASSERT_TRUE(s);
        reflected += !s->transmitted;
        EXPECT_NEAR(s->weight.x, s->transmitted ? 0.8 / 2.25 : 0.8, 1e-5);
    }
    EXPECT_NEAR(reflected, 40, 1);
    // Index 0: no split, light passes straight.
    b.eta = 0;
    const V3f wo(0.6f, 0, 0.8f);
    EXPECT_EQ(sample_bsdf<kAllLobes>(b, wo, 0.99f, {0.5f, 0.5f})->wi, -wo);
    EXPECT_NEAR(sample_bsdf<kAllLobes>(b, wo, 0.24f, {0.5f, 0.5f})->wi.z, 0.8f, 1e-6);
}

TEST(Bsdf, StaysFiniteAtTheEdgesOfItsDomain) {
    const float last = 1 - 0x1p-24f;
    for (const uint32_t lobes :
         {kLobeDiffuse | kLobeMicrofacet, kLobeMicrofacet | kLobeTransmission,
          kLobeDiffuse | kLobePhong, uint32_t{kLobeSpecular}})
        for (const float alpha : {0.0f, 1.01e-4f, 1e-3f, 1.0f})
            for (const float eta : {0.0f, 1.0f, 1.000001f, 1.5f, 100.0f})
                for (const float z : {1.0f, 1e-3f, 1.7e-5f, 1e-8f, 1e-30f, 0.0f}) {
                    Bsdf b;
                    b.lobes = lobes;
                    b.diffuse = b.phong = b.transmission = b.mirror = b.refraction = V3f(0.5f);
                    b.metal_f0 = V3f(0.5f);
                    b.metallic = 0.5f;
                    b.alpha = alpha;
                    b.eta = eta;
                    b.exponent = 1e6f * alpha;
                    for (const bool solid : {false, true})
                        for (const float u : {0.0f, 0.25f, 0.5f, last})
                            for (const float v : {0.0f, 0.5f, last}) {
                                b.thin_walled = !solid;
                                b.entering = v > 0.2f;
                                const V3f wo(std::sqrt(1 - z * z), 0, z);
                                const auto s = sample_bsdf<kAllLobes>(b, wo, v, {u, v});
                                if (!s) continue;
                                ASSERT_TRUE(std::isfinite(s->weight.length()) && s->weight.x >= 0 &&
                                            std::isfinite(s->wi.length()) &&
                                            s->pdf_solid_angle >= 0)
                                    << lobes << ' ' << alpha << ' ' << eta << ' ' << z;
                                ASSERT_LT(s->weight.x, 1e4f) << lobes << ' ' << alpha << ' ' << eta;
                            }
                }
}

} // namespace
} // namespace ql
