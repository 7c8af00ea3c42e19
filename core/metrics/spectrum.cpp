#include "metrics/spectrum.h"

#include "metrics/fourier.h"
#include "metrics/sum.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace ql {

namespace {

std::vector<double> window_weights(int n, Window window) {
    std::vector<double> weights(size_t(n), 1.0);
    if (window == Window::hann && n > 1)
        for (int i = 0; i < n; ++i)
            weights[size_t(i)] = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * (i + 0.5) / n);
    return weights;
}

struct Windowed {
    Array2D<double> values; // weight (f - mean), of sum 0
    double mean = 0;        // weighted
    double energy = 0;      // sum of squared weights
};

Windowed windowed(const Array2D<float>& frame, Window window) {
    const std::vector<double> across = window_weights(frame.width(), window);
    const std::vector<double> down = window_weights(frame.height(), window);
    Windowed result;
    Sum weights, values, energy;
    for (int y = 0; y < frame.height(); ++y)
        for (int x = 0; x < frame.width(); ++x) {
            const double weight = across[size_t(x)] * down[size_t(y)];
            weights.add(weight);
            values.add(weight * double(frame(x, y)));
            energy.add(weight * weight);
        }
    result.mean = values.value() / weights.value();
    result.energy = energy.value();
    result.values = Array2D<double>(frame.width(), frame.height());
    // A constant has no spectrum, whatever rounding leaves of it
    const auto [low, high] = std::minmax_element(frame.values().begin(), frame.values().end());
    if (*low == *high) return result;
    for (int y = 0; y < frame.height(); ++y)
        for (int x = 0; x < frame.width(); ++x)
            result.values(x, y) =
                across[size_t(x)] * down[size_t(y)] * (double(frame(x, y)) - result.mean);
    return result;
}

int signed_frequency(int u, int n) {
    return u <= n / 2 ? u : u - n;
}

// Calls body(|f|^2, power) for every frequency but 0, in the order of the rows.
template<class Body>
void for_each_frequency(const Spectrum& spectrum, const Body& body) {
    for (int v = 0; v < spectrum.power.height(); ++v)
        for (int u = 0; u < spectrum.power.width(); ++u)
            if (u != 0 || v != 0) body(squared_frequency(spectrum, u, v), spectrum.power(u, v));
}

double total_power(const Spectrum& spectrum) {
    Sum total;
    for (const double power : spectrum.power.values())
        total.add(power);
    return total.value();
}

} // namespace

double squared_frequency(const Spectrum& spectrum, int u, int v) {
    const double x = double(signed_frequency(u, spectrum.power.width())) / spectrum.power.width();
    const double y = double(signed_frequency(v, spectrum.power.height())) / spectrum.power.height();
    return x * x + y * y;
}

Spectrum mean_spectrum(std::span<const Array2D<float>> frames, Window window,
                       const Workers& workers) {
    QL_CHECK(!frames.empty());
    Spectrum spectrum;
    spectrum.frames = int(frames.size());
    spectrum.power = Array2D<double>(frames.front().width(), frames.front().height());
    for (const Array2D<float>& frame : frames) {
        QL_CHECK_EQ(frame.width(), spectrum.power.width());
        QL_CHECK_EQ(frame.height(), spectrum.power.height());
        const Windowed input = windowed(frame, window);
        const auto transformed = fourier(input.values, workers);
        for (size_t i = 1; i < transformed.size(); ++i)
            spectrum.power[i] +=
                std::norm(transformed[i]) / (input.energy * double(spectrum.frames));
        spectrum.mean += input.mean / double(spectrum.frames);
    }
    spectrum.variance = total_power(spectrum) / double(spectrum.power.size());
    return spectrum;
}

std::vector<RadialBin> radial_profile(const Spectrum& spectrum) {
    const int side = std::min(spectrum.power.width(), spectrum.power.height());
    struct Ring {
        Sum sum, squares;
        int samples = 0;
    };
    std::vector<Ring> rings(static_cast<size_t>(side));
    const auto visit = [&](const auto& add) {
        for_each_frequency(spectrum, [&](double squared, double power) {
            const auto ring = size_t(std::lround(std::sqrt(squared) * side));
            if (ring < rings.size()) add(rings[ring], power / spectrum.variance);
        });
    };
    // Means first, then squared distances from them
    visit([](Ring& ring, double power) {
        ring.sum.add(power);
        ++ring.samples;
    });
    visit([](Ring& ring, double power) {
        const double distance = power - ring.sum.value() / ring.samples;
        ring.squares.add(distance * distance);
    });
    std::vector<RadialBin> profile;
    for (size_t i = 1; i < rings.size(); ++i) {
        const Ring& ring = rings[i];
        if (ring.samples == 0) continue;
        const double mean = ring.sum.value() / ring.samples;
        const double variance = ring.squares.value() / std::max(ring.samples - 1, 1);
        profile.push_back({double(i) / side, ring.samples, mean,
                           ring.samples < 2 ? std::numeric_limits<double>::quiet_NaN()
                                            : 10 * std::log10(variance / (mean * mean))});
    }
    return profile;
}

double low_frequency_share(const Spectrum& spectrum, double f) {
    Sum low;
    for_each_frequency(spectrum, [&](double squared, double power) {
        if (squared < f * f) low.add(power);
    });
    return low.value() / total_power(spectrum);
}

double low_frequency_power(const Spectrum& spectrum, double f) {
    Sum low;
    int samples = 0;
    for_each_frequency(spectrum, [&](double squared, double power) {
        if (squared >= f * f) return;
        low.add(power);
        ++samples;
    });
    return low.value() / (samples * spectrum.variance);
}

FilteredVariance filtered_variance(const Spectrum& spectrum, double sigma_px) {
    const double scale = -4 * std::numbers::pi * std::numbers::pi * sigma_px * sigma_px;
    Sum left, white;
    for_each_frequency(spectrum, [&](double squared, double power) {
        const double gain = std::exp(scale * squared);
        left.add(gain * power);
        white.add(gain);
    });
    return {left.value() / total_power(spectrum),
            left.value() / (white.value() * spectrum.variance)};
}

double autocorrelation(const Spectrum& spectrum, int dx, int dy) {
    const int width = spectrum.power.width(), height = spectrum.power.height();
    Sum sum;
    for (int v = 0; v < height; ++v)
        for (int u = 0; u < width; ++u) {
            const double turns =
                double(int64_t(u) * dx % width) / width + double(int64_t(v) * dy % height) / height;
            sum.add(spectrum.power(u, v) * std::cos(2 * std::numbers::pi * turns));
        }
    return sum.value() / total_power(spectrum);
}

} // namespace ql
