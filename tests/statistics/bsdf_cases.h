// The BSDFs and directions that the statistical tests run over.
#pragma once

#include "shading/bsdf.h"

#include <cmath>
#include <string>
#include <vector>

namespace ql {

struct BsdfCase {
    std::string name;
    Bsdf bsdf;
};

inline Bsdf lambert(float albedo) {
    Bsdf b;
    b.diffuse = V3f(albedo);
    return b;
}

inline Bsdf metal(float alpha, const V3f& f0 = V3f(1)) {
    Bsdf b;
    b.lobes = kLobeMicrofacet;
    b.metallic = 1;
    b.metal_f0 = f0;
    b.alpha = alpha;
    return b;
}

inline Bsdf coated(float alpha, float eta, float albedo = 1) {
    Bsdf b = lambert(albedo);
    b.lobes = kLobeDiffuse | kLobeMicrofacet;
    b.alpha = alpha;
    b.eta = eta;
    return b;
}

enum class Wall { thin, solid_from_outside, solid_from_inside };

inline Bsdf glass(float alpha, float eta, Wall wall) {
    Bsdf b;
    b.lobes = kLobeTransmission | kLobeMicrofacet;
    b.alpha = alpha;
    b.eta = eta;
    b.transmission = V3f(1);
    b.thin_walled = wall == Wall::thin;
    b.entering = wall != Wall::solid_from_inside;
    return b;
}

inline Bsdf phong(float kd, float ks, float exponent) {
    Bsdf b = lambert(kd);
    b.lobes = (kd > 0 ? kLobeDiffuse : 0u) | kLobePhong;
    b.phong = V3f(ks);
    b.exponent = exponent;
    return b;
}

inline Bsdf phong_glass(float kr, float kt, float eta, Wall wall) {
    Bsdf b;
    b.lobes = kLobeSpecular;
    b.mirror = V3f(kr);
    b.refraction = V3f(kt);
    b.eta = eta;
    b.thin_walled = false;
    b.entering = wall != Wall::solid_from_inside;
    return b;
}

// One of everything that has a density.
inline std::vector<BsdfCase> rough_cases() {
    Bsdf half_metal = coated(0.25f, 1.5f, 0.3f);
    half_metal.metallic = 0.5f;
    half_metal.metal_f0 = V3f(0.9f, 0.6f, 0.2f);
    Bsdf frosted = glass(0.3f, 1.5f, Wall::thin);
    frosted.lobes |= kLobeDiffuse;
    frosted.diffuse = V3f(0.4f);
    frosted.transmission = V3f(0.5f, 0.4f, 0.1f);
    Bsdf everything = phong(0.3f, 0.4f, 20);
    everything.lobes |= kLobeSpecular;
    everything.mirror = V3f(0.1f);
    everything.refraction = V3f(0.2f);
    return {{"lambert", lambert(0.8f)},
            {"metal 1", metal(1)},
            {"metal 0.2", metal(0.2f)},
            {"metal 0.001", metal(0.001f)},
            {"black metal", metal(0.7f, V3f(0))},
            {"coated 0.1", coated(0.1f, 1.5f)},
            {"coated, index 1.000001", coated(0.5f, 1.000001f)},
            {"coated, index 100", coated(0.5f, 100)},
            {"half metal", half_metal},
            {"thin glass", glass(0.3f, 1.5f, Wall::thin)},
            {"frosted wall", frosted},
            {"glass 0.3", glass(0.3f, 1.5f, Wall::solid_from_outside)},
            {"glass 0.05", glass(0.05f, 1.5f, Wall::solid_from_outside)},
            {"glass 0.3 from inside", glass(0.3f, 1.5f, Wall::solid_from_inside)},
            {"glass 1, index 1.1", glass(1, 1.1f, Wall::solid_from_outside)},
            {"glass with smooth refraction", glass(0.01f, 1.005f, Wall::solid_from_outside)},
            {"phong 0", phong(0, 1, 0)},
            {"phong 40", phong(0.5f, 0.5f, 40)},
            {"phong 10000", phong(0.2f, 0.7f, 1e4f)},
            {"phong 1000000", phong(0, 1, 1e6f)},
            {"everything of phong", everything}};
}

inline V3f direction(double degrees_from_normal, double azimuth_degrees = 30) {
    const double theta = degrees_from_normal * M_PI / 180;
    const double phi = azimuth_degrees * M_PI / 180;
    return V3f(static_cast<float>(std::sin(theta) * std::cos(phi)),
               static_cast<float>(std::sin(theta) * std::sin(phi)),
               static_cast<float>(std::cos(theta)));
}

} // namespace ql
