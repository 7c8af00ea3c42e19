#include "metrics/filter.h"

#include <cmath>
#include <numeric>

namespace ql {

namespace {

void normalise(std::vector<double>& taps) {
    const double sum = std::accumulate(taps.begin(), taps.end(), 0.0);
    for (double& tap : taps)
        tap /= sum;
}

int inside(int i, int n, Border border) {
    if (border == Border::wrap) return wrap(i, n);
    const int r = wrap(i, 2 * n);
    return r < n ? r : 2 * n - 1 - r;
}

// A line with `radius` pixels from beyond the border at either end.
void extend(std::vector<double>& line, int n, int radius, Border border) {
    for (int i = 1; i <= radius; ++i) {
        line[size_t(radius - i)] = line[size_t(radius + inside(-i, n, border))];
        line[size_t(radius + n - 1 + i)] = line[size_t(radius + inside(n - 1 + i, n, border))];
    }
}

Array2D<float> filtered_rows(const Array2D<float>& image, std::span<const double> taps,
                             Border border, const Workers& workers) {
    const int width = image.width();
    const int radius = int(taps.size() / 2);
    Array2D<float> result(width, image.height());
    workers.for_each(size_t(image.height()), [&](size_t y) {
        const auto from = image.row(int(y));
        const auto to = result.row(int(y));
        std::vector<double> line(size_t(width + 2 * radius));
        std::copy(from.begin(), from.end(), line.begin() + radius);
        extend(line, width, radius, border);
        std::vector<double> sums(size_t(width), 0.0);
        for (size_t k = 0; k < taps.size(); ++k)
            for (size_t x = 0; x < sums.size(); ++x)
                sums[x] += taps[k] * line[x + k];
        std::copy(sums.begin(), sums.end(), to.begin());
    });
    return result;
}

Array2D<float> filtered_columns(const Array2D<float>& image, std::span<const double> taps,
                                Border border, const Workers& workers) {
    const int radius = int(taps.size() / 2);
    Array2D<float> result(image.width(), image.height());
    workers.for_each(size_t(image.height()), [&](size_t y) {
        std::vector<double> sums(size_t(image.width()), 0.0);
        for (size_t k = 0; k < taps.size(); ++k) {
            const auto row = image.row(inside(int(y) + int(k) - radius, image.height(), border));
            for (size_t x = 0; x < sums.size(); ++x)
                sums[x] += taps[k] * double(row[x]);
        }
        std::copy(sums.begin(), sums.end(), result.row(int(y)).begin());
    });
    return result;
}

} // namespace

std::vector<double> gaussian_taps(double sigma_px) {
    QL_CHECK(sigma_px >= 0 && sigma_px < 1e5);
    if (sigma_px == 0) return {1.0};
    const int radius = int(std::ceil(4 * sigma_px));
    std::vector<double> taps;
    for (int x = -radius; x <= radius; ++x)
        taps.push_back(std::exp(-0.5 * x * x / (sigma_px * sigma_px)));
    normalise(taps);
    return taps;
}

std::vector<double> box_taps(int size) {
    QL_CHECK(size > 0 && size % 2 == 1);
    return std::vector<double>(size_t(size), 1.0 / size);
}

std::vector<double> binomial_taps(int order) {
    QL_CHECK(order >= 0);
    std::vector<double> taps = {1.0};
    for (int i = 0; i < order; ++i) {
        taps.push_back(0);
        for (size_t k = taps.size() - 1; k > 0; --k)
            taps[k] += taps[k - 1];
    }
    normalise(taps);
    return taps;
}

Array2D<float> filtered(const Array2D<float>& image, std::span<const double> taps, Border border,
                        const Workers& workers) {
    QL_CHECK(!taps.empty());
    if (image.empty() || taps.size() == 1) return image;
    return filtered_columns(filtered_rows(image, taps, border, workers), taps, border, workers);
}

} // namespace ql
