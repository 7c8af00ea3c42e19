#include "metrics/false_color.h"

#include <algorithm>
#include <cmath>
#include <iterator>

namespace ql {

namespace {

// sRGB-encoded, at equal distances.
const Imath::V3f kStops[] = {{0.00f, 0.00f, 0.00f}, {0.12f, 0.08f, 0.45f}, {0.50f, 0.08f, 0.60f},
                             {0.85f, 0.28f, 0.40f}, {0.97f, 0.58f, 0.20f}, {0.98f, 0.85f, 0.40f},
                             {1.00f, 1.00f, 1.00f}};

// IEC 61966-2-1
float linear_from_srgb(float v) {
    return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
}

} // namespace

Imath::V3f false_color(float t) {
    if (std::isnan(t)) return {0, 1, 0};
    constexpr int kLast = int(std::size(kStops)) - 1;
    const float at = std::clamp(t, 0.0f, 1.0f) * float(kLast);
    const int i = std::min(int(at), kLast - 1);
    const float f = at - float(i);
    const Imath::V3f encoded = kStops[i] * (1 - f) + kStops[i + 1] * f;
    return {linear_from_srgb(encoded.x), linear_from_srgb(encoded.y), linear_from_srgb(encoded.z)};
}

Image heat_picture(const Array2D<float>& values, double low, double high) {
    Image picture(values.width(), values.height());
    auto &r = picture.plane("R"), &g = picture.plane("G"), &b = picture.plane("B");
    for (size_t i = 0; i < values.size(); ++i) {
        const double t = std::log(double(values[i]) / low) / std::log(high / low);
        const Imath::V3f color = false_color(float(t));
        r[i] = color.x, g[i] = color.y, b[i] = color.z;
    }
    return picture;
}

} // namespace ql
