#include "shading/spot_cone.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

constexpr float kLeastRamp = 1e-3f;

// The ramp ((outer - h) / width)^2 for h from `full` to the rim, and 1 before.
struct Ramp {
    double outer, width, full;

    explicit Ramp(const SpotCone& cone)
        : outer(double(cone.outer)), width(double(std::max(cone.outer - cone.inner, kLeastRamp))),
          full(std::max(outer - width, 0.0)) {}

    double integral() const { return std::pow(outer - full, 3) / (3 * width * width); }
};

// 1 - cos(outer)^n for n = exponent + 1; nothing shines backwards.
double lobe(const SpotCone& cone) {
    const double h = std::min(double(cone.outer), 1.0);
    return -std::expm1((double(cone.exponent) + 1) * std::log1p(-h));
}

double one_minus_cos_of(double angle) {
    const double s = std::sin(angle / 2);
    return 2 * s * s;
}

} // namespace

float SpotCone::falloff(float h) const {
    if (h > outer) return 0;
    if (exponent >= 0)
        return h < 1 ? std::exp(exponent * std::log1p(-h)) : exponent == 0 ? 1.0f : 0.0f;
    const float inside = std::min(1.0f, (outer - h) / std::max(outer - inner, kLeastRamp));
    return inside * inside;
}

double SpotCone::integral() const {
    if (exponent >= 0) return lobe(*this) / (double(exponent) + 1);
    const Ramp ramp(*this);
    return ramp.integral() + ramp.full;
}

// Inverts the integral of the falloff.
double SpotCone::sample(double u) const {
    if (exponent >= 0) return -std::expm1(std::log1p(-lobe(*this) * u) / (double(exponent) + 1));
    const Ramp ramp(*this);
    const double v = u * (ramp.integral() + ramp.full);
    if (v < ramp.integral()) return ramp.outer - std::cbrt(3 * v * ramp.width * ramp.width);
    return ramp.full - (v - ramp.integral());
}

SpotCone spot_cone(double inner_angle, double outer_angle, double exponent) {
    return {float(one_minus_cos_of(inner_angle)), float(one_minus_cos_of(outer_angle)),
            float(exponent)};
}

} // namespace ql
