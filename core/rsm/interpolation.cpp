#include "rsm/interpolation.h"

#include <cmath>

namespace ql {

namespace {

constexpr float kLeastNormalCosine = 0.99f;
constexpr float kMostPlaneSlope = 0.05f;

bool agrees(const Receiver& a, const Receiver& b) {
    if (a.ns.dot(b.ns) < kLeastNormalCosine || a.ng.dot(b.ng) < kLeastNormalCosine) return false;
    const V3f way = a.position - b.position;
    return std::abs(b.ng.dot(way)) <= kMostPlaneSlope * way.length() + b.offset + a.offset;
}

} // namespace

std::optional<V3f> interpolated_irradiance(const Receiver& receiver,
                                           const GridIrradiance* const corners[4], float s,
                                           float t) {
    // Three of four must agree; the weights of one that does not go to the others.
    const float weights[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
    V3f sum(0);
    float weight = 0;
    int agreeing = 0;
    for (int i = 0; i < 4; ++i) {
        if (!corners[i]->valid || !agrees(receiver, corners[i]->receiver)) continue;
        ++agreeing;
        sum += corners[i]->irradiance * weights[i];
        weight += weights[i];
    }
    if (agreeing < 3 || !(weight > 0.25f)) return std::nullopt;
    return sum / weight;
}

} // namespace ql
