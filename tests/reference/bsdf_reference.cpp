#include "reference/bsdf_reference.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ql::reference {

namespace {

double smith_lambda(double cosine, double alpha) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return (std::sqrt(1 + alpha * alpha * tangent2) - 1) / 2;
}

} // namespace

double fresnel(double cos_i, double eta) {
    const double sin_t = std::sqrt(std::max(0.0, 1 - cos_i * cos_i)) / eta;
    if (sin_t >= 1) return 1;
    const double cos_t = std::sqrt(1 - sin_t * sin_t);
    const double rs = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    const double rp = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    return (rs * rs + rp * rp) / 2;
}

double ggx_albedo(double cos_o, double alpha) {
    constexpr int kSteps = 600;
    const double sin_o = std::sqrt(1 - cos_o * cos_o);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        // D(h) cos(h) in equal shares would be tan^2 = alpha^2 u / (1 - u); 1 - u = s^4 refines the
        // tail, which counts at grazing angles, and weighs it with du / ds.
        const double s = (i + 0.5) / kSteps;
        const double rest = s * s * s * s;
        const double cos_h = 1 / std::sqrt(1 + alpha * alpha * (1 - rest) / rest);
        const double sin_h = std::sqrt(1 - cos_h * cos_h);
        for (int j = 0; j < kSteps; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / kSteps;
            const double cos_oh = sin_o * sin_h * std::cos(phi) + cos_o * cos_h;
            const double cos_i = 2 * cos_oh * cos_h - cos_o;
            if (cos_oh <= 0 || cos_i <= 0) continue;
            const double g2 = 1 / (1 + smith_lambda(cos_o, alpha) + smith_lambda(cos_i, alpha));
            sum += 4 * s * s * s * g2 * cos_oh / (cos_o * cos_h);
        }
    }
    return sum / (double{kSteps} * kSteps);
}

double phong_albedo(double cos_o, double exponent) {
    constexpr int kSteps = 600;
    const double sin_o = std::sqrt(1 - cos_o * cos_o);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
        // (n + 1)/(2 pi) cos^n in equal shares about the mirror direction.
        const double log_cos = std::log((i + 0.5) / kSteps) / (exponent + 1);
        const double cosine = std::exp(log_cos);
        const double sine = std::sqrt(-std::expm1(2 * log_cos));
        for (int j = 0; j < kSteps; ++j) {
            const double phi = std::numbers::pi * (j + 0.5) / kSteps;
            sum += std::max(0.0, cosine * cos_o + sine * std::cos(phi) * sin_o);
        }
    }
    return (exponent + 2) / (exponent + 1) * sum / (double{kSteps} * kSteps);
}

} // namespace ql::reference
