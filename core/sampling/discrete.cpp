#include "sampling/discrete.h"

#include <algorithm>
#include <cmath>

namespace ql {

namespace {

// Below this share of the mean weight no random double would ever draw an item.
constexpr double kLeastShareOfMean = 0x1p-53;

bool is_drawable(double weight) {
    return weight > 0 && std::isfinite(weight);
}

} // namespace

AliasTable::AliasTable(std::span<const double> weights) {
    // Scale by the largest weight, so that no sum overflows.
    double largest = 0;
    for (const double w : weights)
        if (is_drawable(w)) largest = std::max(largest, w);
    if (largest == 0) return;
    double relative_sum = 0;
    for (const double w : weights)
        if (is_drawable(w)) relative_sum += w / largest;
    m_sum = relative_sum * largest;

    // Express each weight in units of the mean.
    const size_t n = weights.size();
    m_slots.resize(n);
    std::vector<double> scaled(n);
    std::vector<uint32_t> small, large;
    for (size_t i = 0; i < n; ++i) {
        const double share = is_drawable(weights[i]) ? weights[i] / largest / relative_sum : 0;
        scaled[i] = share * static_cast<double>(n);
        if (scaled[i] < kLeastShareOfMean) scaled[i] = 0;
        m_slots[i] = {1, static_cast<float>(scaled[i] > 0 ? share : 0), static_cast<uint32_t>(i)};
        (scaled[i] < 1 ? small : large).push_back(static_cast<uint32_t>(i));
    }

    // Fill each small slot up with a part of a large one.
    while (!small.empty() && !large.empty()) {
        const uint32_t s = small.back();
        const uint32_t l = large.back();
        small.pop_back();
        m_slots[s].threshold = scaled[s];
        m_slots[s].alias = l;
        scaled[l] -= 1 - scaled[s];
        if (scaled[l] < 1) {
            large.pop_back();
            small.push_back(l);
        }
    }

    // Rounding may leave small slots that should be full; none may keep a weight of zero.
    const auto heaviest =
        static_cast<uint32_t>(std::max_element(m_slots.begin(), m_slots.end(),
                                               [](const Slot& a, const Slot& b) {
                                                   return a.probability < b.probability;
                                               }) -
                              m_slots.begin());
    for (const uint32_t s : small)
        if (m_slots[s].probability == 0) m_slots[s] = {0, 0, heaviest};
}

} // namespace ql
