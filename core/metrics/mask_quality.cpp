#include "metrics/mask_quality.h"

#include "metrics/filter.h"
#include "metrics/sum.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace ql {

namespace {

constexpr int kThresholds = 128; // t = 0/128 .. 127/128, of which the first has no error

// Calls body(first, last) for each run of equal values in the sorted order of pixels.
template<class Body>
void for_each_value(const Array2D<float>& mask, std::vector<size_t>& order, const Body& body) {
    order.resize(mask.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return mask[a] < mask[b]; });
    for (size_t first = 0; first < order.size();) {
        size_t last = first;
        while (last < order.size() && mask[order[last]] == mask[order[first]])
            ++last;
        body(first, last);
        first = last;
    }
}

struct Steps {
    Sum sum, squares;
    size_t count = 0;
    void add(float a, float b) {
        const double step = std::abs(double(a) - double(b));
        sum.add(step);
        squares.add(step * step);
        ++count;
    }
    double mean() const { return sum.value() / double(count); }
};

double seam_error(const Steps& seam, const Steps& inside) {
    if (inside.count < 2) return 0;
    const double variance = std::max(0.0, inside.squares.value() / double(inside.count) -
                                              inside.mean() * inside.mean());
    const double difference = seam.mean() - inside.mean();
    return difference == 0 ? 0 : difference / std::sqrt(variance / double(seam.count));
}

} // namespace

Array2D<float> rank_values(const Array2D<float>& mask) {
    Array2D<float> ranks(mask.width(), mask.height());
    std::vector<size_t> order;
    for_each_value(mask, order, [&](size_t first, size_t last) {
        const double u = 0.5 * double(first + last) / double(mask.size());
        for (size_t i = first; i < last; ++i)
            ranks[order[i]] = float(u);
    });
    return ranks;
}

double heaviside_rms(const Array2D<float>& ranks, std::span<const double> taps,
                     const Workers& workers) {
    std::vector<double> means(kThresholds - 1);
    const Workers inner(1);
    workers.for_each(means.size(), [&](size_t i) {
        const float t = float(i + 1) / kThresholds;
        Array2D<float> error(ranks.width(), ranks.height());
        for (size_t p = 0; p < error.size(); ++p)
            error[p] = (ranks[p] < t ? 1.0f : 0.0f) - t;
        Sum sum;
        for (const float value : filtered(error, taps, Border::wrap, inner).values())
            sum.add(double(value) * double(value));
        means[i] = sum.value() / double(error.size());
    });
    return std::sqrt(std::accumulate(means.begin(), means.end(), 0.0) / kThresholds);
}

std::vector<NamedRms> heaviside_table(const Array2D<float>& ranks, const Workers& workers) {
    const std::vector<std::pair<std::string, std::vector<double>>> filters = {
        {"gauss_1", gaussian_taps(1)},    {"gauss_0.7", gaussian_taps(0.7)},
        {"binomial_2", binomial_taps(2)}, {"binomial_3", binomial_taps(3)},
        {"box_3", box_taps(3)},           {"box_5", box_taps(5)}};
    std::vector<NamedRms> table;
    for (const auto& [name, taps] : filters)
        table.push_back({name, heaviside_rms(ranks, taps, workers)});
    return table;
}

ValueCounts value_counts(const Array2D<float>& mask) {
    ValueCounts counts;
    counts.fewest = mask.size();
    std::vector<size_t> order;
    for_each_value(mask, order, [&](size_t first, size_t last) {
        ++counts.distinct;
        counts.fewest = std::min(counts.fewest, last - first);
        counts.most = std::max(counts.most, last - first);
        const double value = double(mask[order[first]]);
        for (const size_t below : {first, last})
            counts.uniformity_error = std::max(
                counts.uniformity_error, std::abs(double(below) / double(mask.size()) - value));
    });
    return counts;
}

SeamTest seam_test(const Array2D<float>& mask) {
    Steps across, across_seam, down, down_seam;
    for (int y = 0; y < mask.height(); ++y)
        for (int x = 0; x < mask.width(); ++x) {
            const int right = wrap(x + 1, mask.width()), below = wrap(y + 1, mask.height());
            (right == 0 ? across_seam : across).add(mask(x, y), mask(right, y));
            (below == 0 ? down_seam : down).add(mask(x, y), mask(x, below));
        }
    return {seam_error(across_seam, across), seam_error(down_seam, down)};
}

} // namespace ql
