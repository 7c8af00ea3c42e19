#include "metrics/error.h"

#include "metrics/sum.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace ql {

namespace {

// Of relmse: the share of mean(R)^2 that keeps black pixels from dividing by zero.
constexpr double kRelativeFloor = 0.01;

bool is_comparable(float image, float reference) {
    return std::isfinite(image) && std::isfinite(reference);
}

double relative_square(double difference, double reference, double floor) {
    return difference == 0 ? 0 : difference * difference / (reference * reference + floor);
}

struct RowSums {
    Sum image, reference, square, relative;
    double max_abs = 0;
    uint64_t samples = 0;
    uint64_t non_finite = 0;
};

// Calls body(row sums, I, R) for every comparable sample; rows are added up in their order.
template<class Body>
RowSums sums_over_rows(std::span<const ChannelPair> channels, const Workers& workers,
                       const Body& body) {
    const int width = channels.front().image->width();
    const int height = channels.front().image->height();
    std::vector<RowSums> rows(static_cast<size_t>(height));
    workers.for_each(rows.size(), [&](size_t y) {
        for (const ChannelPair& channel : channels)
            for (int x = 0; x < width; ++x) {
                const float image = (*channel.image)(x, int(y));
                const float reference = (*channel.reference)(x, int(y));
                if (is_comparable(image, reference))
                    body(rows[y], double(image), double(reference));
                else
                    ++rows[y].non_finite;
            }
    });
    RowSums total;
    for (const RowSums& row : rows) {
        total.image.add(row.image);
        total.reference.add(row.reference);
        total.square.add(row.square);
        total.relative.add(row.relative);
        total.max_abs = std::max(total.max_abs, row.max_abs);
        total.samples += row.samples;
        total.non_finite += row.non_finite;
    }
    return total;
}

struct BlockMeans {
    double image = 0;
    double reference = 0;
    uint64_t samples = 0;
};

BlockMeans block_means(const ChannelPair& channel, int x0, int y0, int block_px) {
    BlockMeans means;
    const int x1 = std::min(x0 + block_px, channel.image->width());
    const int y1 = std::min(y0 + block_px, channel.image->height());
    for (int y = y0; y < y1; ++y)
        for (int x = x0; x < x1; ++x) {
            const float image = (*channel.image)(x, y);
            const float reference = (*channel.reference)(x, y);
            if (!is_comparable(image, reference)) continue;
            means.image += double(image);
            means.reference += double(reference);
            ++means.samples;
        }
    const double n = double(std::max<uint64_t>(means.samples, 1));
    means.image /= n;
    means.reference /= n;
    return means;
}

double block_relmse(std::span<const ChannelPair> channels, int block_px, double floor,
                    uint64_t samples, const Workers& workers) {
    const int width = channels.front().image->width();
    const int height = channels.front().image->height();
    std::vector<Sum> rows(size_t((height + block_px - 1) / block_px));
    workers.for_each(rows.size(), [&](size_t row) {
        for (const ChannelPair& channel : channels)
            for (int x = 0; x < width; x += block_px) {
                const BlockMeans means = block_means(channel, x, int(row) * block_px, block_px);
                rows[row].add(double(means.samples) * relative_square(means.image - means.reference,
                                                                      means.reference, floor));
            }
    });
    Sum total;
    for (const Sum& row : rows)
        total.add(row);
    return total.value() / double(samples);
}

// I - R, zero where either is not finite.
Array2D<float> difference(const ChannelPair& channel) {
    Array2D<float> result(channel.image->width(), channel.image->height());
    for (size_t i = 0; i < result.size(); ++i)
        if (is_comparable((*channel.image)[i], (*channel.reference)[i]))
            result[i] = (*channel.image)[i] - (*channel.reference)[i];
    return result;
}

// samples: those that are finite in both.
double perceptual_mse(const std::vector<Array2D<float>>& differences, uint64_t samples,
                      double sigma_px, const ErrorConfig& config, const Workers& workers) {
    const std::vector<double> taps = gaussian_taps(sigma_px);
    Sum total;
    for (const Array2D<float>& error : differences) {
        const Array2D<float> seen = filtered(error, taps, config.border, workers);
        for (const float value : seen.values())
            total.add(double(value) * double(value));
    }
    return total.value() / double(samples);
}

void check_config(const ErrorConfig& config) {
    if (config.block_px < 1)
        throw usage_error("block side {}, expected 1 or more", config.block_px);
    if (!(config.peak > 0)) throw usage_error("peak {}, expected more than 0", config.peak);
    for (const double sigma : config.sigmas_px)
        if (!(sigma >= 0 && sigma <= 1000))
            throw usage_error("sigma {} px, expected 0..1000", sigma);
}

void check_channels(std::span<const ChannelPair> channels) {
    QL_CHECK(!channels.empty());
    for (const ChannelPair& channel : channels) {
        QL_CHECK(!channel.image->empty());
        for (const Array2D<float>* plane : {channel.image, channel.reference}) {
            QL_CHECK_EQ(plane->width(), channels.front().image->width());
            QL_CHECK_EQ(plane->height(), channels.front().image->height());
        }
    }
}

RowSums first_sums(std::span<const ChannelPair> channels, const Workers& workers) {
    return sums_over_rows(channels, workers, [](RowSums& row, double image, double reference) {
        const double error = image - reference;
        row.image.add(image);
        row.reference.add(reference);
        row.square.add(error * error);
        row.max_abs = std::max(row.max_abs, std::abs(error));
        ++row.samples;
    });
}

template<class Planes>
size_t differing_in(const Planes& planes, const Planes& others) {
    size_t count = 0;
    for (size_t c = 0; c < planes.size(); ++c)
        for (size_t i = 0; i < planes[c].pixels.size(); ++i)
            count += std::bit_cast<uint32_t>(planes[c].pixels[i]) !=
                     std::bit_cast<uint32_t>(others[c].pixels[i]);
    return count;
}

} // namespace

ErrorFigures error_figures(std::span<const ChannelPair> channels, const ErrorConfig& config,
                           const Workers& workers) {
    check_config(config);
    check_channels(channels);

    // Means and absolute errors first: relative ones need mean(R)
    const RowSums sums = first_sums(channels, workers);
    ErrorFigures figures;
    figures.samples = sums.samples;
    figures.non_finite = sums.non_finite;
    if (figures.samples == 0) return figures;
    const double n = double(figures.samples);
    figures.mean_image = sums.image.value() / n;
    figures.mean_reference = sums.reference.value() / n;
    const bool both_zero = figures.mean_image == 0 && figures.mean_reference == 0;
    figures.mean_ratio = both_zero ? 1 : figures.mean_image / figures.mean_reference;
    figures.mse = sums.square.value() / n;
    figures.rmse = std::sqrt(figures.mse);
    figures.psnr_db = figures.mse > 0 ? 10 * std::log10(config.peak * config.peak / figures.mse)
                                      : std::numeric_limits<double>::infinity();
    figures.max_abs = sums.max_abs;

    // Relative errors
    const double floor = kRelativeFloor * figures.mean_reference * figures.mean_reference;
    const RowSums relative =
        sums_over_rows(channels, workers, [&](RowSums& row, double image, double reference) {
            row.relative.add(relative_square(image - reference, reference, floor));
        });
    figures.relmse = relative.relative.value() / n;
    figures.block_relmse = block_relmse(channels, config.block_px, floor, sums.samples, workers);

    // What is left behind a low-pass filter
    std::vector<Array2D<float>> differences;
    if (!config.sigmas_px.empty())
        for (const ChannelPair& channel : channels)
            differences.push_back(difference(channel));
    for (const double sigma : config.sigmas_px)
        figures.perceptual.push_back(
            {sigma, perceptual_mse(differences, sums.samples, sigma, config, workers)});
    return figures;
}

Array2D<float> relative_error(std::span<const ChannelPair> channels, const Workers& workers) {
    check_channels(channels);
    const RowSums sums = first_sums(channels, workers);
    const double mean = sums.reference.value() / double(std::max<uint64_t>(sums.samples, 1));
    const double floor = kRelativeFloor * mean * mean;
    Array2D<float> result(channels.front().image->width(), channels.front().image->height());
    for (size_t i = 0; i < result.size(); ++i) {
        double total = 0;
        for (const ChannelPair& channel : channels) {
            const double image = double((*channel.image)[i]);
            const double reference = double((*channel.reference)[i]);
            total += is_comparable(float(image), float(reference))
                         ? relative_square(image - reference, reference, floor)
                         : std::numeric_limits<double>::quiet_NaN();
        }
        result[i] = float(std::sqrt(total / double(channels.size())));
    }
    return result;
}

size_t differing_samples(const Image& image, const Image& reference) {
    QL_CHECK_EQ(image.planes.size(), reference.planes.size());
    QL_CHECK_EQ(image.uint_planes.size(), reference.uint_planes.size());
    return differing_in(image.planes, reference.planes) +
           differing_in(image.uint_planes, reference.uint_planes);
}

} // namespace ql
